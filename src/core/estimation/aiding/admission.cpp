#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/aiding/reading_limits.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/time_jump.hpp>

#include <cmath>

namespace sonopose::estimation::aiding {
namespace {

bool within(const Vector3d& value, double limit) {
  return value.allFinite() && value.cwiseAbs().maxCoeff() <= limit;
}

}  // namespace

std::optional<ExceededLimit> exceeded_limit(const AdmissionSettings& settings, const ImuSample& imu) {
  if (!within(imu.angular_velocity_body_radps, settings.max_angular_rate_radps))
    return ExceededLimit{"admission.max_angular_rate_radps", settings.max_angular_rate_radps};
  if (!within(imu.specific_force_body_mps2, settings.max_specific_force_mps2))
    return ExceededLimit{"admission.max_specific_force_mps2", settings.max_specific_force_mps2};
  if (imu.specific_force_body_mps2.isZero(0.0)) return ExceededLimit{};
  return std::nullopt;
}

std::optional<ExceededLimit> exceeded_limit(const AdmissionSettings& settings, const UltrasonicFix& fix) {
  const bool is_within = within(fix.position_world_m, settings.max_position_m) &&
                         within(fix.point_body_m, settings.max_position_m);
  if (is_within) return std::nullopt;
  return ExceededLimit{"admission.max_position_m", settings.max_position_m};
}

namespace admission {
namespace {

/// True if a measurement is neither older than the limit nor from the future. Before the first IMU sample the
/// state's time is 0 and no measurement is recent.
bool is_recent(const AdmissionSettings& settings, TimeNs now_ns, TimeNs measured_ns, TimeNs received_ns,
               double ahead_s) {
  if (!is_time(measured_ns) || !is_time(received_ns)) return false;
  const double age_s = seconds_between(measured_ns, now_ns);
  const double delay_s = seconds_between(measured_ns, received_ns);
  return age_s <= settings.max_fix_age_s && age_s >= -ahead_s && delay_s >= -future_tolerance_s &&
         delay_s <= settings.max_fix_age_s;
}

/// True if a measurement is possible but older than the limit.
bool is_too_late(const AdmissionSettings& settings, TimeNs now_ns, TimeNs measured_ns, TimeNs received_ns) {
  return is_time(measured_ns) && is_time(received_ns) && received_ns >= measured_ns &&
         seconds_between(measured_ns, now_ns) > settings.max_fix_age_s;
}

}  // namespace

bool is_time(TimeNs stamp_ns) {
  return stamp_ns > 0 && stamp_ns < end_of_time_ns;
}

bool admits(const AdmissionSettings& settings, TimeNs now_ns, const ImuSample& imu) {
  return is_time(imu.sensor_time_ns) && imu.sensor_time_ns >= now_ns && !exceeded_limit(settings, imu);
}

bool is_time_jump(AdmissionState& state, TimeNs now_ns, const ImuSample& imu) {
  if (now_ns != 0)
    return is_unconfirmed_jump(state.announced_ns, state.ahead_in_row, now_ns, imu.sensor_time_ns);
  state.announced_ns = 0;
  state.ahead_in_row = 0;
  return false;
}

bool needs_time_reset(AdmissionState& state, TimeNs now_ns, const ImuSample& imu) {
  const bool backward = imu.sensor_time_ns > 0 && imu.sensor_time_ns < now_ns;
  state.backward_in_row = backward ? state.backward_in_row + 1 : 0;
  return state.backward_in_row >= max_backward_samples;
}

bool admits(const AdmissionSettings& settings, TimeNs now_ns, const PairHeading& heading, TimeNs measured_ns,
            double ahead_s) {
  return std::isfinite(heading.heading_world_rad) &&
         is_recent(settings, now_ns, measured_ns, heading.received_time_ns, ahead_s);
}

bool is_possible(const TwistSample& twist) {
  constexpr double max_speed_mps = 1000.0;
  const auto is_number = [](const Vector3d& value) { return value.allFinite(); };
  return within(twist.velocity_body_mps, max_speed_mps) && is_number(twist.velocity_std_mps) &&
         is_number(twist.angular_velocity_body_radps) && is_number(twist.angular_velocity_std_radps);
}

bool admits(const AdmissionSettings& settings, TimeNs now_ns, const TwistSample& twist, TimeNs measured_ns,
            double ahead_s) {
  return is_possible(twist) && is_recent(settings, now_ns, measured_ns, twist.received_time_ns, ahead_s);
}

std::uint32_t fix_rejection_flags(const AdmissionSettings& settings, TimeNs now_ns, const UltrasonicFix& fix,
                                  TimeNs measured_ns, double ahead_s) {
  if (exceeded_limit(settings, fix)) return fix_invalid;
  if (is_too_late(settings, now_ns, measured_ns, fix.received_time_ns)) return fix_too_late;
  if (!is_recent(settings, now_ns, measured_ns, fix.received_time_ns, ahead_s)) return fix_invalid;
  const bool poor = fix.quality_percent && !(*fix.quality_percent >= settings.min_quality_percent);
  return poor ? std::uint32_t{fix_low_quality} : 0U;
}

Vector3d completed_position(const UltrasonicFix& fix, const Vector3d& estimated_world_m) {
  constexpr double unknown_std_m = 50.0;
  if ((fix.flags & ultrasonic_flag_set_pose) == 0 || !fix.covariance_world_m2) return fix.position_world_m;
  Vector3d position_world_m = fix.position_world_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (fix.covariance_world_m2->std_dev(axis) >= unknown_std_m)
      position_world_m[axis] = estimated_world_m[axis];
  }
  return position_world_m;
}

std::uint32_t rejection_flags(const AdmissionSettings& settings, AdmissionState& state, TimeNs now_ns,
                              const UltrasonicFix& fix, TimeNs measured_ns) {
  const std::uint32_t flags = fix_rejection_flags(settings, now_ns, fix, measured_ns);
  // A late fix usually comes after newer ones: its age says more than its order.
  if (measured_ns <= state.last_fix_measured_ns && flags != fix_too_late) return fix_invalid;
  if (flags == 0) state.last_fix_measured_ns = measured_ns;
  return flags;
}

}  // namespace admission
}  // namespace sonopose::estimation::aiding
