#pragma once
/// \file
/// Which ROS 2 topics are taken in, and as which beacons.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::ros2 {

/// One topic that is taken in, and the beacon that it counts as.
struct Ros2Input {
  enum class Kind : std::uint8_t { imu, fix };
  Kind kind = Kind::imu;
  std::string topic;
  BeaconAddress address = 0;

  /// "/imu/data=7". Throws std::invalid_argument that says what is wrong.
  static Ros2Input parse(Kind kind, std::string_view text);
};

/// As on the command line: "--imu-in /imu/data=7".
std::string text_of(const Ros2Input& input);

/// Throws std::invalid_argument, naming both, for two topics of one kind that are to count as one beacon:
/// their samples would be mixed, as if one sensor were in two places.
void check(const std::vector<Ros2Input>& inputs);

}  // namespace sonopose::ros2
