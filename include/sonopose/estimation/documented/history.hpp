#pragma once
/// \file
/// The last second of the inertial path, so that a fix or heading can be compared with what the engine
/// thought at the time when it was *measured*.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::estimation::documented {

/// One moment of the path that the IMU alone would have drawn: no fix has bent it.
struct InertialPoint {
  TimeNs time_ns = 0;
  Vector3d displacement_world_m = Vector3d::Zero();  ///< ∫(v − v_corrections) dt since the engine's start
  double yaw_rad = 0;                                ///< yaw with all yaw corrections taken off again

  bool operator==(const InertialPoint&) const = default;
};

/// A ring of fixed size. A newest point that lies closer to the one before it than the spacing gives way to
/// the next, so that the ring spans more than a second at any IMU rate.
class InertialHistory {
public:
  static constexpr std::size_t capacity = 512;
  static constexpr TimeNs spacing_ns = 2'500'000;

  /// Adds a point; its time must not lie before the newest one's.
  void push(const InertialPoint& point);

  /// The path at `time_ns`, interpolated; empty where the history does not reach back so far. Times after the
  /// newest point give the newest point.
  [[nodiscard]] std::optional<InertialPoint> at(TimeNs time_ns) const;

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The points from the oldest, 0, to the newest. Pushed one after the other into an empty history they make
  /// an equal one.
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
