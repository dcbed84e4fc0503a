#include "ros2/relay/parameter_messages.hpp"

#include <sonopose/ros2/messages/borrow.hpp>

#include <array>

namespace sonopose::ros2::relay {

ParameterType type_of(const settings::SettingValue& value) {
  constexpr std::array types{ParameterType::boolean, ParameterType::integer, ParameterType::real,
                             ParameterType::text};
  return types.at(value.index());
}

ros2::ParameterValue value_message(const std::optional<settings::SettingValue>& value) {
  static const std::string nothing;
  ros2::ParameterValue message{};
  message.string_value = ros2::borrow_string(nothing);
  if (!value) return message;
  message.type = static_cast<std::uint8_t>(type_of(*value));
  if (const auto* const flag = std::get_if<bool>(&*value)) message.bool_value = *flag;
  if (const auto* const count = std::get_if<int>(&*value)) message.integer_value = *count;
  if (const auto* const number = std::get_if<double>(&*value)) message.double_value = *number;
  if (const auto* const word = std::get_if<std::string>(&*value)) {
    message.string_value = ros2::borrow_string(*word);
  }
  return message;
}

std::optional<std::string> value_text(const ros2::ParameterValue& message) {
  switch (static_cast<ParameterType>(message.type)) {
    case ParameterType::boolean:
      return message.bool_value ? "true" : "false";
    case ParameterType::integer:
      return std::to_string(message.integer_value);
    case ParameterType::real:
      return settings::to_text(message.double_value);
    case ParameterType::text:
      return message.string_value;
    default:
      return std::nullopt;
  }
}

}  // namespace sonopose::ros2::relay
