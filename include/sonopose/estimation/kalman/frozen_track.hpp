#pragma once
/// \file
/// Detection of fixes that repeat their coordinates while the IMU measures motion.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::kalman {

struct FrozenTrackDetector {
  bool has_fix = false;
  bool frozen = false;
  int repeats = 0;
  Vector3d coordinates_world_m = Vector3d::Zero();
  TimeNs began_ns = 0;
  Vector3d moved_world_m = Vector3d::Zero();       ///< inertial path since `began_ns`, without corrections
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< velocity along this path

  /// Adds an IMU step.
  void move(double duration_s, const Vector3d& acceleration_world_mps2);
  /// Adds a fix after a sample at `time_ns`. Returns true if the track is frozen.
  bool add(const settings::FrozenSettings& settings, TimeNs time_ns, const Vector3d& position_world_m,
           const Vector3d& velocity_world_mps);
  bool operator==(const FrozenTrackDetector&) const = default;
};

void for_each_field(IsFieldsOf<FrozenTrackDetector> auto& detector, const auto& visit) {
  visit("has_fix", detector.has_fix);
  visit("frozen", detector.frozen);
  visit("repeats", detector.repeats);
  visit("coordinates_world_m", detector.coordinates_world_m);
  visit("began_ns", detector.began_ns);
  visit("moved_world_m", detector.moved_world_m);
  visit("velocity_world_mps", detector.velocity_world_mps);
}

}  // namespace sonopose::estimation::kalman
