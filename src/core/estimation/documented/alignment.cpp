#include <sonopose/estimation/documented/alignment.hpp>
#include <sonopose/estimation/documented/heading.hpp>
#include <sonopose/estimation/documented/lag.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::alignment {

void correct_tilt(const AlignmentSettings& settings, AlignmentState& state, attitude::AnyFilter& filter,
                  const Vector3d& velocity_change_world_mps) {
  // A turn φ of the attitude adds φ × g·z to the acceleration; φ = z × dv / g turns it towards dv.
  const Vector3d turn_world_rad =
      settings.tilt_gain_hz / standard_gravity_mps2 * Vector3d::UnitZ().cross(velocity_change_world_mps);
  filter.turn_in_world(turn_world_rad);
  if (settings.aiding_s > 0.0) state.pending_world_mps += velocity_change_world_mps;
  const double limit_mps2 = settings.vertical_limit_mps2;
  state.vertical_offset_mps2 =
      std::clamp(state.vertical_offset_mps2 + settings.vertical_gain_hz * velocity_change_world_mps.z(),
                 -limit_mps2, limit_mps2);
}

void set_known_acceleration(const AlignmentSettings& settings, AlignmentState& state,
                            const Vector3d& gained_world_mps, TimeNs now_ns, double dt_s) {
  if (!(settings.aiding_s > 0.0)) return clear_known_acceleration(state);
  if (!(dt_s > 0.0)) return;
  Vector3d reported_world_mps = lag_share(dt_s / settings.aiding_s) * state.pending_world_mps;
  // Limits the feedback of large corrections: the tilt that follows them causes new corrections.
  constexpr double max_reported_mps2 = 1.0;
  const double reported_mps2 = reported_world_mps.norm() / dt_s;
  if (reported_mps2 > max_reported_mps2) reported_world_mps *= max_reported_mps2 / reported_mps2;
  state.pending_world_mps -= reported_world_mps;
  // The learned offset is an error of the accelerometer, not an acceleration of the body.
  state.known_acceleration_world_mps2 = (gained_world_mps + reported_world_mps) / dt_s;
  state.known_acceleration_world_mps2.z() -= state.vertical_offset_mps2;
  state.aiding = true;
  state.aided_ns = now_ns;
}

void suspend(AlignmentState& state, TimeNs now_ns) {
  state.known_acceleration_world_mps2.setZero();
  state.aiding = false;
  state.gated_ns = now_ns;
}

void clear_known_acceleration(AlignmentState& state) {
  state.pending_world_mps.setZero();
  state.known_acceleration_world_mps2.setZero();
  state.aiding = false;
}

void add_known_acceleration(const AlignmentSettings& settings, const AlignmentState& state, TimeNs now_ns,
                            attitude::Measurement<double>& measurement) {
  measurement.acceleration_world_mps2 = state.known_acceleration_world_mps2;
  const bool held = state.aided_ns != 0 && seconds_between(state.aided_ns, now_ns) < settings.hold_s;
  measurement.force_shows_vertical = state.aiding || !held;
}

YawTurn correct_yaw(const AlignmentSettings& settings, AlignmentState& state, Kinematics& body,
                    attitude::AnyFilter& filter, const FixVelocity& measured, double share) {
  const Eigen::Vector2d by_imu = state.gained_world_mps.head<2>();
  const Eigen::Vector2d by_fixes =
      by_imu + (measured.ultrasonic_world_mps - measured.inertial_world_mps).head<2>();
  const double cross = by_imu.x() * by_fixes.y() - by_imu.y() * by_fixes.x();
  const double angle_rad = std::atan2(cross, by_imu.dot(by_fixes));
  const double signal = by_imu.squaredNorm();
  const double yaw_noise_m2ps2 = settings.yaw_noise_mps * settings.yaw_noise_mps;
  const double certainty = signal / (signal + yaw_noise_m2ps2);
  const double yaw_gain = velocity::share_of_several(settings.yaw_gain, measured.usual_fixes);
  const double turn_rad = yaw_gain * certainty * angle_rad;
  YawTurn result{.turn_rad = turn_rad};
  // Noise in the IMU's gain alone is no signal: only the common part of both gains measures yaw.
  const double common = std::min(signal, by_imu.dot(by_fixes));
  if (common > 0.0) {
    result.share = yaw_gain * common / (common + yaw_noise_m2ps2);
    // Consecutive fixes measure the same gain, so their errors are not independent.
    constexpr double correlation = 1.5;
    result.std_rad = correlation * std::sqrt(yaw_noise_m2ps2 / common);
  }

  heading::turn(body, filter, turn_rad);
  const Vector3d gained_world_mps = geometry::rotation_about_z(turn_rad) * state.gained_world_mps;
  body.correct_velocity(gained_world_mps - state.gained_world_mps);
  state.gained_world_mps = (1.0 - share) * gained_world_mps;
  return result;
}

}  // namespace sonopose::estimation::documented::alignment
