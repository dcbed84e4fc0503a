#include <sonopose/estimation/documented/heading.hpp>
#include <sonopose/estimation/documented/lag.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::heading {
namespace {

double mount_rad(const HeadingSettings& settings) {
  return settings.mount_offset_deg * geometry::radians_per_degree;
}

/// Axis of the pair in the world.
Vector3d axis_world(const HeadingSettings& settings, const Quaterniond& q_body_to_world) {
  const double rad = mount_rad(settings);
  return q_body_to_world * Vector3d(std::cos(rad), std::sin(rad), 0.0);
}

/// True unless the pair's axis points up or down, which gives no heading.
bool has_heading(const Vector3d& axis_world) {
  constexpr double min_horizontal = 0.1;
  return axis_world.head<2>().norm() > min_horizontal;
}

double direction_of(const Vector3d& world) {
  return std::atan2(world.y(), world.x());
}

}  // namespace

double yaw_by_pair(const HeadingSettings& settings, const Quaterniond& q_body_to_world) {
  return geometry::wrap_angle(direction_of(axis_world(settings, q_body_to_world)) - mount_rad(settings));
}

void turn(Kinematics& body, attitude::AnyFilter& filter, double angle_rad) {
  filter.turn_in_world({0.0, 0.0, angle_rad});
  body.yaw_corrections_rad = geometry::wrap_angle(body.yaw_corrections_rad + angle_rad);
}

bool is_valid(const HeadingSettings& settings, const HeadingState& state, TimeNs now_ns) {
  return state.known && seconds_between(state.last_received_ns, now_ns) <= settings.expires_s;
}

void set_target(const HeadingSettings& settings, HeadingState& state, Kinematics& body,
                attitude::AnyFilter& filter, const PairHeading& heading, TimeNs measured_ns) {
  const Quaterniond q_body_to_world = filter.orientation();
  if (!heading.valid || !body.started() || !has_heading(axis_world(settings, q_body_to_world))) return;
  const bool of_body = (heading.flags & heading_flag_of_body) != 0;
  const double yaw_measured_rad = heading.heading_world_rad - (of_body ? 0.0 : mount_rad(settings));
  if ((heading.flags & heading_flag_set_pose) != 0) state.known = false;
  const double yaw_then_rad = body.yaw_at(measured_ns).value_or(yaw_by_pair(settings, q_body_to_world));
  const double error_rad = geometry::wrap_angle(yaw_measured_rad - yaw_then_rad);
  if (!state.known) turn(body, filter, error_rad);
  state.wanted_correction_rad =
      state.known ? geometry::wrap_angle(body.yaw_corrections_rad + error_rad) : body.yaw_corrections_rad;
  state.known = true;
  state.last_received_ns = heading.received_time_ns;
}

double correct_from_pair(const HeadingSettings& settings, HeadingState& state, Kinematics& body,
                         attitude::AnyFilter& filter, double dt_s) {
  double turn_rad = state.rate_offset_radps * dt_s;
  double share = 0.0;
  if (is_valid(settings, state, body.time_ns)) {
    const double error_rad = geometry::wrap_angle(state.wanted_correction_rad - body.yaw_corrections_rad);
    // At most critically damped: x″ + k·x′ + b·x = 0 does not oscillate for b ≤ k²/4.
    const double damped_hz2 = 0.25 * settings.pair_gain_hz * settings.pair_gain_hz;
    state.rate_offset_radps += std::min(settings.pair_bias_gain_hz2, damped_hz2) * error_rad * dt_s;
    share = lag_share(settings.pair_gain_hz * dt_s);
    turn_rad += share * error_rad;
  }
  // The learned rate offset also moves the wanted correction.
  state.wanted_correction_rad =
      geometry::wrap_angle(state.wanted_correction_rad + state.rate_offset_radps * dt_s);
  turn(body, filter, turn_rad);
  return share;
}

double correct_from_course(const HeadingSettings& settings, const HeadingState& state, Kinematics& body,
                           attitude::AnyFilter& filter, const FixVelocity& measured) {
  if (is_valid(settings, state, body.time_ns)) return 0.0;
  const double displacement_m = measured.displacement_world_m.head<2>().norm();
  if (displacement_m < settings.min_displacement_m || measured.inertial_world_mps.head<2>().isZero()) {
    return 0.0;
  }
  const double error_rad = geometry::wrap_angle(direction_of(measured.displacement_world_m) -
                                                direction_of(measured.inertial_world_mps));
  const double max_rad = settings.max_correction_deg * geometry::radians_per_degree;
  const double turn_rad = std::clamp(settings.error_gain * error_rad, -max_rad, max_rad);
  turn(body, filter, turn_rad);
  return turn_rad;
}

}  // namespace sonopose::estimation::documented::heading
