#pragma once
/// \file
/// The parameter services of the relay's node (`ros2 param`), and `~/reset`, for clients with rmw_cyclonedds.

#include "ros2/relay/parameters.hpp"
#include "settings_client/settings_client.hpp"
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/node.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2::relay {

/// Uses the settings topics of the fusion, like sonopose-settings. `serve` must run on a thread that may
/// block; construct the server on the thread of the node.
class ParameterServer {
public:
  /// Throws dds::Error, dds::qos::FileError. `participant` must outlive it.
  ParameterServer(ros2::Node& node, const dds::DomainParticipant& participant,
                  const dds::DomainOptions& domain, const std::optional<std::filesystem::path>& qos_file);

  /// Replies to all pending requests. Waits for the fusion at most two seconds per change or reset.
  void serve();

private:
  void take_settings();
  void list(const ros2::ListParameters::Request& request, const auto& reply);
  void get(const ros2::GetParameters::Request& request, const auto& reply);
  void get_types(const ros2::GetParameterTypes::Request& request, const auto& reply);
  void describe(const ros2::DescribeParameters::Request& request, const auto& reply);
  void set(const ros2::SetParameters::Request& request, const auto& reply);
  void set_atomically(const ros2::SetParametersAtomically::Request& request, const auto& reply);
  void reset(const auto& reply);
  std::string change(const std::vector<ros2::Parameter>& parameters);

  settings_client::SettingsClient client_;
  SettingsByBeacon effective_;
  dds::DataReader<sonopose_EffectiveSettings> settings_;
  ros2::Service<ros2::ListParameters> list_;
  ros2::Service<ros2::GetParameters> get_;
  ros2::Service<ros2::GetParameterTypes> get_types_;
  ros2::Service<ros2::DescribeParameters> describe_;
  ros2::Service<ros2::SetParameters> set_;
  ros2::Service<ros2::SetParametersAtomically> set_atomically_;
  ros2::Service<ros2::Trigger> reset_;
};

}  // namespace sonopose::ros2::relay
