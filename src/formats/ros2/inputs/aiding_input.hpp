#pragma once
/// \file
/// ROS 2 topics of velocities, headings and poses, and the beacons that they belong to.

#include "ros2/inputs/input_option.hpp"
#include <sonopose/ros2/messages/twist_input.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::ros2 {

/// One topic, and the address of its beacon.
struct AidingInput {
  enum class Kind : std::uint8_t {
    odometry,  ///< velocities, of --odom-in
    twist,
    wheels,
    heading,
    pose,     ///< fixes and headings
    set_pose  ///< poses at which the estimate starts again
  };
  enum class Type : std::uint8_t {
    odometry,
    twist_with_covariance,
    twist,
    joints,
    imu,
    pose_with_covariance,
    pose,
    degrees,
    set_pose_service  ///< SetPose of robot_localization
  };
  Kind kind = Kind::odometry;
  Type type = Type::odometry;
  std::string topic;  ///< or service
  BeaconAddress address = 0;
  Wheels wheels = {};  ///< for Kind::wheels alone

  /// Parses "/odom=7" or, with one of the types of its kind, "/wheel/twist:TwistStamped=7". Throws
  /// std::invalid_argument.
  static AidingInput parse(Kind kind, std::string_view text);
};

[[nodiscard]] bool is_velocity(AidingInput::Kind kind);

/// Name of the option of a kind: "--odom-in".
[[nodiscard]] const char* option_name(AidingInput::Kind kind);

/// Text as on the command line, without a type: "--odom-in /odom=7".
[[nodiscard]] std::string text_of(const AidingInput& input);

/// Input as which a topic is monitored.
[[nodiscard]] Input monitored_as(const AidingInput& input);

/// Throws std::invalid_argument for two topics of one beacon whose errors would be taken for independent: two
/// of velocities, of headings or of poses. Throws it also for a service of two beacons.
void check(const std::vector<AidingInput>& inputs);

}  // namespace sonopose::ros2
