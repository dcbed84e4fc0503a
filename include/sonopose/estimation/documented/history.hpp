#pragma once
/// \file
/// The last second of the inertial path. A fix or heading is compared with the engine's estimate at the time
/// of its measurement.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::estimation::documented {

/// One point of the path by the IMU alone, without corrections by fixes.
struct InertialPoint {
  TimeNs time_ns = 0;
  Vector3d displacement_world_m = Vector3d::Zero();  ///< ∫(v − v_corrections) dt since the engine's start
  double yaw_rad = 0;                                ///< yaw by the pair (heading), without yaw corrections

  bool operator==(const InertialPoint&) const = default;
};

/// A ring buffer of fixed size. A newest point closer to its predecessor than the spacing is replaced by the
/// next point, so that the buffer spans more than a second at any IMU rate.
class InertialHistory {
public:
  using value_type = InertialPoint;
  static constexpr std::size_t capacity = 512;
  static constexpr TimeNs spacing_ns = 2'500'000;

  /// Adds a point that `accepts` admits.
  void push(const InertialPoint& point);

  /// True if a point is not older than the newest one.
  [[nodiscard]] bool accepts(const InertialPoint& point) const {
    return empty() || point.time_ns >= newest().time_ns;
  }

  /// Path at `time_ns`, interpolated; empty if the history begins later. Times after the newest point give
  /// the newest point.
  [[nodiscard]] std::optional<InertialPoint> at(TimeNs time_ns) const;

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Points from the oldest, 0, to the newest. Pushing them in order into an empty history gives an equal
  /// one.
  [[nodiscard]] const InertialPoint& operator[](std::size_t index) const { return back(size_ - 1 - index); }
  [[nodiscard]] const InertialPoint& newest() const { return points_[last_]; }

  void clear() { size_ = 0; }

  bool operator==(const InertialHistory& other) const;

private:
  [[nodiscard]] const InertialPoint& back(std::size_t steps) const {
    return points_[(last_ + capacity - steps) % capacity];
  }

  std::array<InertialPoint, capacity> points_{};
  std::size_t last_ = 0;
  std::size_t size_ = 0;
};

}  // namespace sonopose::estimation::documented
