#include <sonopose/fusion/alignment.hpp>
#include <sonopose/fusion/heading.hpp>
#include <sonopose/math/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::fusion::alignment {

void level(const AlignmentSettings& settings, AlignmentState& state, attitude::Mahony& filter,
           const Vector3d& velocity_change_world_mps) {
  // A turn φ of the attitude adds φ × g·z to the acceleration: φ = z × dv / g turns it towards dv.
  const Vector3d turn_world_rad =
      settings.tilt_gain_hz / standard_gravity_mps2 * Vector3d::UnitZ().cross(velocity_change_world_mps);
  filter.turn_in_world(turn_world_rad);
  const double limit_mps2 = settings.vertical_limit_mps2;
  state.vertical_offset_mps2 =
      std::clamp(state.vertical_offset_mps2 + settings.vertical_gain_hz * velocity_change_world_mps.z(),
                 -limit_mps2, limit_mps2);
}

double turn(const AlignmentSettings& settings, AlignmentState& state, Kinematics& body,
            attitude::Mahony& filter, const FixVelocity& measured, double share) {
  const Eigen::Vector2d by_imu = state.gained_world_mps.head<2>();
  const Eigen::Vector2d by_fixes =
      by_imu + (measured.ultrasonic_world_mps - measured.inertial_world_mps).head<2>();
  const double cross = by_imu.x() * by_fixes.y() - by_imu.y() * by_fixes.x();
  const double angle_rad = std::atan2(cross, by_imu.dot(by_fixes));
  const double signal = by_imu.squaredNorm();
  const double certainty = signal / (signal + settings.yaw_noise_mps * settings.yaw_noise_mps);
  const double turn_rad = settings.yaw_gain * certainty * angle_rad;

  heading::turn(body, filter, turn_rad);
  const Vector3d gained_world_mps = math::rotation_about_z(turn_rad) * state.gained_world_mps;
  body.correct_velocity(gained_world_mps - state.gained_world_mps);
  state.gained_world_mps = (1.0 - share) * gained_world_mps;
  return turn_rad;
}

}  // namespace sonopose::fusion::alignment
