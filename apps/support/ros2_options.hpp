#pragma once
// How the relay appears in ROS 2, on the command line.

#include "ros2/relay/relay.hpp"
#include <sonopose/ros2/messages/environment.hpp>

#include <CLI/CLI.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

struct Ros2Options {
  ros2::NodeName node;
  std::vector<std::string> remap;
  std::optional<ros2::Distro> distro;
  std::string enclave = "/";
  std::optional<std::string> addresses;
  ros2::relay::Output output;
  std::array<double, 6> mount{};  ///< x, y, z in m; roll, pitch, yaw in degrees
  std::vector<std::string> imu_in;
  std::vector<std::string> fix_in;
};

/// After add_bus_options(), whose --network means another default here.
void add_ros2_options(CLI::App& app, Ros2Options& options);

/// What the node needs, but for the bus; says on stderr what is odd in the environment. Throws
/// std::invalid_argument that names option or variable.
ros2::relay::RelayOptions relay_options(const Ros2Options& options, const ros2::Variables& environment);

}  // namespace sonopose::apps
