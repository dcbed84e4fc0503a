#pragma once
/// \file
/// Conversion between values of settings and of ROS 2 parameters.

#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// rcl_interfaces/msg/ParameterType.
enum class ParameterType : std::uint8_t {
  not_set = 0,
  boolean = 1,
  integer = 2,
  real = 3,
  text = 4,
  reals = 8,
  texts = 9
};

ParameterType type_of(const settings::SettingValue& value);

/// `value` must outlive the message.
ros2::ParameterValue value_message(const std::optional<settings::SettingValue>& value);

/// Value as text; empty for a type that no setting has.
std::optional<std::string> value_text(const ros2::ParameterValue& message);

}  // namespace sonopose::ros2::relay
