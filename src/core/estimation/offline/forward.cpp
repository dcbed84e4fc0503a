#include "estimation/offline/forward.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <Eigen/LU>

#include <algorithm>

namespace sonopose::estimation::offline {

using kalman::Filter;
using kalman::ImuMeasurement;
using kalman::Matrix3d;

namespace {

constexpr double square(double x) {
  return x * x;
}

bool is_used(const JudgedFix& fix) {
  return fix.used;
}

/// Attitude at the first sample: that of the settled filter, turned back by the gyroscope.
Quaterniond first_attitude(const Segment& segment) {
  Quaterniond q = segment.settled.q_body_to_world;
  const auto& imu = segment.imu;
  auto last = std::find_if(imu.begin(), imu.end(), [&](const ImuMeasurement& sample) {
    return sample.time_ns >= segment.settled_ns;
  });
  if (last == imu.end()) --last;
  for (; last != imu.begin(); --last) {
    const kalman::ImuStep step = kalman::step_between(*(last - 1), *last, segment.nominal_imu_period_s);
    const Vector3d rate_radps = step.rate_body_radps - segment.settled.gyro_bias_body_radps;
    q = (q * geometry::rotation_by((-step.duration_s * rate_radps).eval())).normalized();
  }
  return q;
}

/// Correction by an innovation with the columns P Hᵀ.
Correction correction_of(const kalman::FixJacobian& jacobian, const kalman::StateColumns& columns,
                         const Matrix3d& innovation_covariance, const Vector3d& innovation) {
  Correction correction;
  correction.jacobian = jacobian;
  correction.information = innovation_covariance.inverse();
  correction.weighted_innovation = correction.information * innovation;
  correction.gain = columns * correction.information;
  return correction;
}

/// Moves the state as the engine did, and adds uncertainty of the same size.
void change_track(Filter& filter, const TrackChange& change) {
  filter.position_world_m += change.jump_world_m;
  filter.velocity_world_mps += change.velocity_change_world_mps;
  filter.q_body_to_world =
      (geometry::rotation_about_z(change.yaw_change_rad) * filter.q_body_to_world).normalized();
  const auto same = [](double variance) { return Vector3d::Constant(variance); };
  filter.add_variance(kalman::at_position, same(change.jump_world_m.squaredNorm()));
  filter.add_variance(kalman::at_velocity, same(change.velocity_change_world_mps.squaredNorm()));
  filter.add_yaw_variance(square(change.yaw_change_rad));
}

}  // namespace

Forward::Forward(const settings::Settings& settings, const Segment& segment, const Noise& noise)
    : segment_(segment),
      noise_(noise),
      imu_gap_ns_(to_ns(settings.outage.imu_gap_s)),
      mount_rad_(settings.heading.mount_offset_deg * geometry::radians_per_degree) {}

bool Forward::can_start(const Segment& segment) {
  return !segment.imu.empty() && std::any_of(segment.fixes.begin(), segment.fixes.end(), is_used);
}

ForwardState Forward::start(const Segment& segment) {
  // No fix has been used yet, so position and velocity are unknown.
  constexpr double unknown_position_std_m = 10.0;
  constexpr double unknown_velocity_std_mps = 10.0;
  constexpr double tilt_std_rad = 3.0 * geometry::radians_per_degree;
  constexpr double yaw_std_rad = 10.0 * geometry::radians_per_degree;
  ForwardState state;
  Filter& filter = state.filter;
  filter.q_body_to_world = first_attitude(segment);
  filter.gyro_bias_body_radps = segment.settled.gyro_bias_body_radps;
  filter.accel_bias_body_mps2 = segment.settled.accel_bias_body_mps2;
  filter.lever_arm_body_m = segment.settled.lever_arm_body_m;
  const auto fix = std::find_if(segment.fixes.begin(), segment.fixes.end(), is_used);
  filter.position_world_m = fix->measured.position_world_m +
                            filter.q_body_to_world * (filter.lever_arm_body_m - fix->measured.point_body_m);
  auto variances = filter.covariance.diagonal();
  variances.segment<3>(kalman::at_position).setConstant(square(unknown_position_std_m));
  variances.segment<3>(kalman::at_velocity).setConstant(square(unknown_velocity_std_mps));
  variances.segment<3>(kalman::at_attitude).setConstant(square(tilt_std_rad));
  variances.segment<3>(kalman::at_gyro_bias).setConstant(square(kalman::start_gyro_bias_std_radps));
  variances.segment<3>(kalman::at_accel_bias).setConstant(square(kalman::start_accel_bias_std_mps2));
  variances.segment<3>(kalman::at_lever_arm).setConstant(square(kalman::start_lever_arm_std_m));
  filter.add_yaw_variance(std::max(square(yaw_std_rad), segment.settled.yaw_variance_rad2()));
  state.time_ns = segment.imu.front().time_ns;
  return state;
}

void Forward::step(ForwardState& state, std::vector<Operation>* operations) const {
  if (state.next_imu > 0) move(state, operations);
  const TimeNs now_ns = segment_.imu[state.next_imu++].time_ns;
  for (; state.next_state < segment_.states.size(); ++state.next_state) {
    const StateMeasurement& measured = segment_.states[state.next_state];
    if (measured.time_ns > now_ns) break;
    use(state, measured, operations);
  }
  use_until(
      state,
      state.next_imu < segment_.imu.size() ? segment_.imu[state.next_imu].time_ns : now_ns + imu_gap_ns_,
      operations);
}

/// Moves the state to the next sample.
void Forward::move(ForwardState& state, std::vector<Operation>* operations) const {
  const ImuMeasurement& next = segment_.imu[state.next_imu];
  const kalman::ImuStep step =
      kalman::step_between(segment_.imu[state.next_imu - 1], next, segment_.nominal_imu_period_s);
  if (step.duration_s > 0.0) {
    state.filter.predict(step.rate_body_radps, step.force_body_mps2, step.duration_s);
    if (operations != nullptr || step.irregular) propagate(state, operations);
    if (step.irregular) kalman::add_missed_motion(state.filter, step);
  }
  for (; state.next_dropped < segment_.dropped.size() &&
         segment_.dropped[state.next_dropped].time_ns <= next.time_ns;
       ++state.next_dropped) {
    const DroppedMotion& dropped = segment_.dropped[state.next_dropped];
    propagate(state, operations);
    state.filter.add_uncertain_motion(kalman::dropped_share * dropped.impulse_body_mps,
                                      kalman::dropped_share * dropped.turn_body_rad);
  }
  state.time_ns = next.time_ns;
}

void Forward::propagate(ForwardState& state, std::vector<Operation>* operations) const {
  if (!(state.filter.pending.duration_s > 0.0)) return;
  if (operations != nullptr) operations->emplace_back(state.filter.transition());
  state.filter.propagate(noise_.process);
}

/// Uses the fixes and headings measured before `end_ns`.
void Forward::use_until(ForwardState& state, TimeNs end_ns, std::vector<Operation>* operations) const {
  while (true) {
    const auto* fix = state.next_fix < segment_.fixes.size() ? &segment_.fixes[state.next_fix] : nullptr;
    const auto* heading =
        state.next_heading < segment_.headings.size() ? &segment_.headings[state.next_heading] : nullptr;
    if (fix != nullptr && fix->measured.time_ns >= end_ns) fix = nullptr;
    if (heading != nullptr && heading->measured.time_ns >= end_ns) heading = nullptr;
    if (fix != nullptr && (heading == nullptr || fix->measured.time_ns <= heading->measured.time_ns)) {
      ++state.next_fix;
      use(state, *fix, operations);
    } else if (heading != nullptr) {
      ++state.next_heading;
      use(state, *heading, operations);
    } else {
      return;
    }
  }
}

void Forward::use(ForwardState& state, const StateMeasurement& measured,
                  std::vector<Operation>* operations) const {
  propagate(state, operations);
  Filter& filter = state.filter;
  const Vector3d& estimate =
      measured.index == kalman::at_velocity ? filter.velocity_world_mps : filter.gyro_bias_body_radps;
  const Vector3d innovation = measured.value - estimate;
  if (operations != nullptr) {
    kalman::FixJacobian jacobian = kalman::FixJacobian::Zero();
    jacobian.middleCols<3>(measured.index).setIdentity();
    const kalman::StateColumns columns = filter.covariance.middleCols<3>(measured.index);
    const Matrix3d covariance =
        columns.middleRows<3>(measured.index) + measured.variance * Matrix3d::Identity();
    operations->emplace_back(correction_of(jacobian, columns, covariance, innovation));
  }
  filter.update_direct(measured.index, innovation, measured.variance);
}

void Forward::use(ForwardState& state, const JudgedFix& fix, std::vector<Operation>* operations) const {
  if (!fix.used) return;
  propagate(state, operations);
  Filter& filter = state.filter;
  if (fix.track_change) change_track(filter, *fix.track_change);
  const double ahead_s = seconds_between(state.time_ns, fix.measured.time_ns);
  const kalman::Innovation innovation =
      filter.fix_innovation(fix.measured.position_world_m, square(noise_.fix_scale) * fix.covariance_world_m2,
                            ahead_s, fix.measured.point_body_m);
  constexpr double max_squared_norm = 16.0;  // a stray fix must not decide on the noise
  state.log_likelihood -=
      0.5 * (std::min(innovation.squared_norm, max_squared_norm) + innovation.log_determinant);
  if (operations != nullptr) {
    operations->emplace_back(correction_of(filter.fix_jacobian(ahead_s, fix.measured.point_body_m),
                                           innovation.columns, innovation.covariance_m2,
                                           innovation.value_world_m));
  }
  filter.correct_fix(innovation);
}

void Forward::use(ForwardState& state, const JudgedHeading& heading,
                  std::vector<Operation>* operations) const {
  if (!heading.used) return;
  propagate(state, operations);
  Filter& filter = state.filter;
  if (heading.added_yaw_variance_rad2 > 0.0) filter.add_yaw_variance(heading.added_yaw_variance_rad2);
  const double ahead_s = seconds_between(state.time_ns, heading.measured.time_ns);
  const double heading_rad = heading.measured.heading_world_rad;
  const auto innovation = filter.heading_innovation(heading_rad, mount_rad_, heading.variance_rad2, ahead_s);
  if (!innovation.observable) return;
  if (operations != nullptr) {
    Correction correction;
    correction.jacobian.row(0).segment<3>(kalman::at_attitude) = innovation.row;
    correction.information(0, 0) = 1.0 / innovation.variance_rad2;
    correction.weighted_innovation.x() = innovation.value_rad / innovation.variance_rad2;
    correction.gain.col(0) = innovation.column / innovation.variance_rad2;
    operations->emplace_back(correction);
  }
  filter.correct_heading(heading_rad, mount_rad_, heading.variance_rad2, ahead_s);
}

}  // namespace sonopose::estimation::offline
