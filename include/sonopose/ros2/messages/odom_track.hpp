#pragma once
/// \file
/// Where another odometry source (wheels, a camera) says the robot is, for `map → odom` (REP-105).

#include <sonopose/samples/samples.hpp>
#include <sonopose/ros2/messages/frames.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::ros2 {

/// The latest transforms odom → base, to be asked for any time between them. Not for several threads at
/// once. Allocates nothing.
class OdomTrack {
public:
  /// One that is not newer than the latest is left out, but for a clock that was set back by a second.
  void add(TimeNs time_ns, const Transform& base_in_odom);

  /// The base in odom at `time_ns`, interpolated; beyond the latest one, that one, for up to `hold_ns`.
  /// Empty where nothing is known.
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

/// Where odom must stand in the map so that the base stands where the fusion says: T_map_base ·
/// T_odom_base⁻¹.
inline Transform odom_in_map(const Transform& base_in_map, const Transform& base_in_odom) {
  return base_in_map * inverse_of(base_in_odom);
}

}  // namespace sonopose::ros2
