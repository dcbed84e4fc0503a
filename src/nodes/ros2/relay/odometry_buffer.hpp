#pragma once
/// \file
/// Buffer of another odometry source (wheels, a camera), for `map → odom` (REP-105).

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::ros2::relay {

/// The latest transforms odom → base, with interpolation. Not thread-safe. Does not allocate memory.
class OdometryBuffer {
public:
  /// Adds a transform, unless it is not newer than the latest one. A step back of more than a second clears
  /// the buffer: the clock was set.
  void add(TimeNs time_ns, const Transform& base_in_odom);

  /// Interpolated pose of the base in odom at `time_ns`; for up to `hold_ns` after the latest transform, that
  /// transform. Empty otherwise.
  [[nodiscard]] std::optional<Transform> at(TimeNs time_ns) const;

  static constexpr TimeNs hold_ns = 200'000'000;

private:
  struct Entry {
    TimeNs time_ns = 0;
    Transform base_in_odom;
  };
  [[nodiscard]] const Entry& from_latest(std::size_t back) const {
    return entries_[(next_ + entries_.size() - 1 - back) % entries_.size()];
  }

  std::array<Entry, 256> entries_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

/// Pose of odom in the map that gives the base its fused pose: T_map_base · T_odom_base⁻¹.
inline Transform odom_in_map(const Transform& base_in_map, const Transform& base_in_odom) {
  return base_in_map * inverse_of(base_in_odom);
}

}  // namespace sonopose::ros2::relay
