#pragma once
/// \file
/// The parameter services of the relay's node (`ros2 param`), and `~/reset`, for clients on rmw_cyclonedds.

#include <sonopose/dds/qos/provider.hpp>
#include "ros2/relay/parameters.hpp"
#include "settings_client/settings_client.hpp"
#include <sonopose/ros2/messages/node.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Asks the fusion by the topics by which every program asks it. For one thread, which it may keep waiting;
/// made where the node is used.
class Ros2ParameterServer {
public:
  /// Throws dds::Error, dds::QosFileError. `participant` must outlive it.
  Ros2ParameterServer(ros2::Node& node, const dds::DomainParticipant& participant,
                      const dds::DomainOptions& domain, const std::optional<std::filesystem::path>& qos_file);

  /// Answers the requests that have come. Waits for a fusion for two seconds at most, each time that
  /// something is to be set or reset.
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
  std::string changed(const std::vector<ros2::Parameter>& parameters);

  settings_client::SettingsClient client_;
  SettingsByBeacon in_force_;
  dds::DataReader<sonopose_EffectiveSettings> settings_;
  ros2::Service<ros2::ListParameters> list_;
  ros2::Service<ros2::GetParameters> get_;
  ros2::Service<ros2::GetParameterTypes> get_types_;
  ros2::Service<ros2::DescribeParameters> describe_;
  ros2::Service<ros2::SetParameters> set_;
  ros2::Service<ros2::SetParametersAtomically> set_atomically_;
  ros2::Service<ros2::Trigger> reset_;
};

}  // namespace sonopose::ros2
