#pragma once
/// \file
/// ROS 2 topics that are inputs, and the beacons that they represent.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::ros2 {

/// The type of a topic of fixes: PointStamped or PoseWithCovarianceStamped of geometry_msgs.
enum class FixType : std::uint8_t { point, pose };

/// The type of a topic of an IMU: sensor_msgs/Imu, or px4_msgs/SensorCombined.
enum class ImuType : std::uint8_t { ros, px4 };

/// One input topic, and the address of its beacon.
struct Input {
  enum class Kind : std::uint8_t { imu, fix, twist, heading, pose };
  Kind kind = Kind::imu;
  std::string topic;
  BeaconAddress address = 0;
  ImuMeaning imu_meaning = ImuMeaning::unknown;  ///< not defined by sensor_msgs/Imu
  ImuType imu_type = ImuType::ros;
  std::optional<FixType> fix_type = {};     ///< empty: type of the topic's first publisher
  std::string tag_frame = {};               ///< frame of the located point; empty: `tag_base_m`
  std::optional<Vector3d> tag_base_m = {};  ///< its place on the base; empty: it is the tracked point

  /// Parses "/imu/data=7", "/fmu/out/sensor_combined:SensorCombined=7", or for a fix also
  /// "/tag/pose:PointStamped=7", "/tag/pose=7@tag_link" with the frame of the tag and "/tag/pose=7@0.2,0,0.5"
  /// with its place on the base (m). Throws std::invalid_argument.
  static Input parse(Kind kind, std::string_view text);
};

/// A topic, with its type if one is given, and the address of its beacon.
struct TopicOfBeacon {
  std::string topic;
  BeaconAddress address = 0;
};

/// Parses "/imu/data=7". Throws std::invalid_argument with the option, the fault and the example.
TopicOfBeacon parse_topic(std::string_view option, std::string_view text, std::string_view example);

/// Text as on the command line: "--imu-in /imu/data=7".
std::string text_of(const Input& input);

/// DDS type of its messages; empty if not known yet.
std::string message_type_of(const Input& input);

/// Type of fixes with this DDS name; empty for any other type.
std::optional<FixType> fix_type_named(std::string_view dds_type_name);

/// Throws std::invalid_argument for two topics of fixes of one beacon, unless their tags have places of their
/// own: only one may be at the tracked point. A beacon may have two topics of IMU samples, one of its
/// accelerometer and one of its gyroscope.
void check(const std::vector<Input>& inputs);

/// Advice on a topic of fixes whose type another option takes, as "geometry_msgs/msg/PoseStamped"; otherwise
/// empty.
std::string advice_on_type(std::string_view topic, std::string_view type);

}  // namespace sonopose::ros2
