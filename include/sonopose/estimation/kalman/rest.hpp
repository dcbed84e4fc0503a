#pragma once
/// \file
/// Detection of rest from the spread of the IMU over windows of half a second.

#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::kalman {

struct RestState {
  TimeNs window_began_ns = 0;
  int samples = 0;
  Vector3d gyro_mean = Vector3d::Zero();
  Vector3d gyro_squares = Vector3d::Zero();  ///< Welford's sum of squared deviations
  Vector3d accel_mean = Vector3d::Zero();
  Vector3d accel_squares = Vector3d::Zero();
  int still_windows = 0;                        ///< consecutive
  TimeNs still_since_ns = 0;                    ///< beginning of the first of them
  Vector3d still_gyro_mean = Vector3d::Zero();  ///< of the latest still window
  Vector3d still_accel_mean = Vector3d::Zero();
  // The fixes since then: regression of the position over time.
  int fixes = 0;
  double time_mean_s = 0;
  double time_squares_s2 = 0;
  Vector3d position_mean_m = Vector3d::Zero();
  Vector3d products_m_s = Vector3d::Zero();

  bool operator==(const RestState&) const = default;
};

namespace rest {

/// Adds a sample. True if it completes a still window: the mean rate and force of the window are then those
/// of rest, if the body does not cruise smoothly.
bool update(RestState& state, TimeNs time_ns, const Vector3d& rate_body_radps,
            const Vector3d& force_body_mps2, const Vector3d& gyro_bias_body_radps, double bias_std_radps);

/// Adds a fix that was used.
void add_fix(RestState& state, TimeNs time_ns, const Vector3d& position_world_m);

/// Ends the rest: a gap in the samples.
void restart(RestState& state);

/// Whether the fixes since the rest began agree with a body that does not move.
[[nodiscard]] bool fixes_stand_still(const RestState& state, double fix_std_m);

}  // namespace rest
}  // namespace sonopose::estimation::kalman
