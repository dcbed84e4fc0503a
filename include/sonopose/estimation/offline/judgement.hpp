#pragma once
/// \file
/// The measurements of a recording as the Kalman engine judged them while it ran forward: what smoothing and
/// the estimation of parameters start from.

#include <sonopose/estimation/kalman/state.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sonopose::estimation::offline {

/// By how much the engine moved its state when it changed to another track of fixes.
struct TrackChange {
  Vector3d jump_world_m = Vector3d::Zero();
  Vector3d velocity_change_world_mps = Vector3d::Zero();
  double yaw_change_rad = 0;
};

struct JudgedFix {
  kalman::FixMeasurement measured;
  std::uint64_t sequence = 0;  ///< of the fix's event
  std::uint32_t flags = 0;     ///< bits of FixFlag
  bool used = false;
  /// With which the engine used or rejected it: its own or the learned one, enlarged between the two gates.
  kalman::Matrix3d covariance_world_m2 = kalman::Matrix3d::Zero();
  std::optional<TrackChange> track_change{};  ///< if the engine changed to the track of this fix
};

struct JudgedHeading {
  kalman::HeadingMeasurement measured;
  std::uint64_t sequence = 0;  ///< of the heading's event
  bool used = false;
  double variance_rad2 = 0;  ///< with which the engine used or rejected it, enlarged between the gates
  double added_yaw_variance_rad2 = 0;  ///< that yaw got before it, because headings disagreed for long
};

/// What the engine concluded from the IMU or from the silence of the fixes: the gyro bias or no velocity at
/// rest, and the weak bound on the velocity of dead reckoning.
struct StateMeasurement {
  TimeNs time_ns = 0;
  kalman::StateIndex index = kalman::at_velocity;  ///< the first of three states
  Vector3d value = Vector3d::Zero();
  double variance = 0;  ///< of each component
};

/// The measurements between two starts of the estimate or silences of the IMU; each list is in ascending time
/// of measurement. It may have no fix, and its last fixes and headings may be of a silence.
struct Segment {
  std::vector<kalman::ImuMeasurement> imu;  ///< calibrated; from at most a second before the first fix on
  std::vector<JudgedFix> fixes;
  std::vector<JudgedHeading> headings;  ///< each after the fix of its emission
  std::vector<StateMeasurement> states;
  double usual_step_s = 0;  ///< between most samples
  TimeNs settled_ns = 0;    ///< when the engine had followed a known yaw for some seconds; else the end
  kalman::Filter settled;   ///< the engine's best filter then
};

/// Runs the Kalman engine over a recording's events, in the order of their arrival, and returns what it made
/// of them. An event that the engine does not admit is left out; so is a fix or heading before the first fix.
/// Times are those of the measurement: the delay is compensated as the settings say. The verdicts are those
/// of the moment; only the fixes of a frozen track are taken back from its first repetition on.
[[nodiscard]] std::vector<Segment> judged(const settings::Settings& settings, std::span<const Event> events);

}  // namespace sonopose::estimation::offline
