#pragma once
// Command-line options of the relay.

#include "command_line.hpp"
#include "ros2/relay/relay.hpp"
#include <sonopose/ros2/node/environment.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

struct Ros2Options {
  ros2::NodeName node;
  std::vector<std::string> remap;
  std::optional<ros2::Distro> distro;
  std::string enclave = "/";  ///< name to announce
  std::optional<std::string> addresses;
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;
  ros2::relay::Output output;
  std::array<double, 6> mount{};  ///< x, y, z in m; roll, pitch, yaw in degrees
  std::vector<std::string> imu_in;
  std::vector<std::string> fix_in;
  std::vector<std::string> odom_in;
  std::vector<std::string> twist_in;
  std::vector<std::string> wheel_in;
  std::optional<std::string> wheels;
  std::vector<std::string> heading_in;
  std::vector<std::string> pose_in;
  std::vector<std::string> set_pose_in;
  std::optional<ImuMeaning> imu_meaning;
  std::optional<std::string> px4;
  std::optional<std::string> ardupilot;
  std::optional<double> north_rad;  ///< --north, which is given in degrees
  bool use_sim_time = false;
  ros2::relay::ServicesMode services = ros2::relay::ServicesMode::automatic;
};

/// Adds the options. Call it after add_bus_options(), since it changes the description of --network.
void add_ros2_options(CommandLine& app, Ros2Options& options);

/// Returns the name of the node after remapping. Throws std::invalid_argument with the option.
ros2::NodeName node_name(const Ros2Options& options);

/// Returns the options of the relay without those of the bus. Logs a warning for an unknown ROS_DISTRO.
/// Throws std::invalid_argument with the option or variable.
ros2::relay::RelayOptions relay_options(const Ros2Options& options, const ros2::Variables& environment);

}  // namespace sonopose::apps
