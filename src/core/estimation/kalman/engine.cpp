#include "estimation/kalman/state_internal.hpp"
#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/outputs.hpp>
#include <sonopose/settings/preset.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace sonopose::estimation::kalman {

namespace {

/// True if a fix's own covariance is positive definite.
bool is_usable(const Covariance<3>& covariance) {
  const Matrix3d matrix = covariance.matrix();
  const Eigen::LLT<Matrix3d> factor(matrix);
  return matrix.allFinite() && factor.info() == Eigen::Success;
}

/// 0 means unknown.
TimeNs stamp_or_none(TimeNs stamp_ns) {
  return aiding::admission::is_time(stamp_ns) ? stamp_ns : 0;
}

}  // namespace

ImuMeasurement as_measurement(const ImuSample& calibrated) {
  return {.time_ns = calibrated.sensor_time_ns,
          .rate_body_radps = calibrated.angular_velocity_body_radps,
          .force_body_mps2 = calibrated.specific_force_body_mps2,
          .is_mean = calibrated.meaning == ImuMeaning::mean_since_last};
}

Engine::Engine(const settings::Settings& settings)
    : settings_(settings::resolved(settings)), calibration_(settings.calibration) {}

void Engine::configure(const settings::Settings& settings) noexcept {
  finish_pending_work();  // earlier events must not depend on the new settings
  const double mount_before_deg = settings_.heading.mount_offset_deg;
  settings_ = settings::resolved(settings);
  calibration_ = calibration::Calibration(settings.calibration);
  const double change_rad = geometry::wrap_angle((settings_.heading.mount_offset_deg - mount_before_deg) *
                                                 geometry::radians_per_degree);
  if (change_rad != 0.0) buffer_.on_mount_offset_change(change_rad);
}

void Engine::finish_pending_work() noexcept {
  if (!buffer_.has_pending_work()) return;
  buffer_.finish_pending_work(settings_);
  update_uncertainty();
}

/// Updates what needs nearly the whole covariance, for which a pose need not wait.
void Engine::update_uncertainty() {
  constexpr double unlearned_bias_radps = 0.01;
  constexpr double wrong_gain_mps2 = 0.5;  // a bias of five initial deviations: a wrong unit, gain or sign
  constexpr double other_clock_s = 0.04;
  constexpr double unknown_yaw_rad = 5.0 * geometry::radians_per_degree;
  if (state().phase == Phase::waiting) return;
  const Filter& filter = state().filter();
  const double bias_std = std::sqrt(filter.covariance.diagonal().segment<3>(at_gyro_bias).maxCoeff());
  uncertainty_ = {.pose_covariance = filter.pose_covariance(),
                  .velocity_covariance = filter.velocity_covariance(),
                  .gyro_bias_is_unknown = bias_std > unlearned_bias_radps,
                  .clocks_differ = state().bank.best().imu == ImuModel::other_clock &&
                                   std::abs(filter.delay_error_s) > other_clock_s,
                  .accel_bias_is_large = filter.accel_bias_body_mps2.norm() > wrong_gain_mps2};
  if (state().is_ambiguous()) {
    const Spread spread = state().spread();
    Covariance<6>::Matrix pose = uncertainty_.pose_covariance.matrix();
    pose.topLeftCorner<3, 3>() += spread.position_m2;
    pose(5, 5) += spread.yaw_rad2;
    uncertainty_.pose_covariance = Covariance<6>::from_matrix(pose);
    uncertainty_.velocity_covariance =
        Covariance<3>::from_matrix(uncertainty_.velocity_covariance.matrix() + spread.velocity_m2ps2);
  }
  uncertainty_.yaw_is_unknown =
      state().phase == Phase::searching_yaw || uncertainty_.pose_covariance.std_dev(5) > unknown_yaw_rad;
}

void Engine::reset() noexcept {
  buffer_.clear();
  set_yaw_.reset();
  admission_ = {};
  last_used_received_ns_ = 0;
  last_delay_s_ = 0;
  last_position_world_m_.setZero();
  ++reset_counter_;
}

void Engine::restore(const Snapshot& snapshot) noexcept {
  buffer_.restore(settings_, snapshot.history);
  update_uncertainty();
  set_yaw_.reset();
  admission_ = snapshot.admission;
  last_used_received_ns_ = snapshot.last_used_received_ns;
  last_delay_s_ = snapshot.last_delay_s;
  last_position_world_m_ = snapshot.last_position_world_m;
  counters_ = snapshot.counters;
  reset_counter_ = snapshot.reset_counter;
}

Snapshot Engine::snapshot() const {
  if (buffer_.has_pending_work()) {
    Engine whole = *this;
    whole.finish_pending_work();
    return whole.snapshot();
  }
  return {.history = buffer_.history(),
          .admission = admission_,
          .last_used_received_ns = last_used_received_ns_,
          .last_delay_s = last_delay_s_,
          .last_position_world_m = last_position_world_m_,
          .counters = counters_,
          .reset_counter = reset_counter_};
}

std::optional<FusedPose> Engine::predict(const ImuSample& raw) noexcept {
  finish_pending_work();
  const ImuSample imu = calibration_.corrected(raw);
  if (!admit(imu)) return std::nullopt;
  const ImuMeasurement measured = as_measurement(imu);
  const bool last_twist_was_rejected = state().twist && state().twist->rejected;
  const bool comes_last = buffer_.add(settings_, measured);
  count_dropped(last_twist_was_rejected);
  const FusedPose pose = comes_last && is_step(measured) ? pose_after_step(imu, measured) : whole_pose(imu);
  last_position_world_m_ = pose.position_world_m;
  return pose;
}

/// Corrects the counts of measurements that came since the last sample, and that this one has removed.
void Engine::count_dropped(bool last_twist_was_rejected) {
  const auto [headings, twists] = buffer_.dropped();
  const auto move = [](std::uint64_t& from, std::uint64_t& to, std::uint64_t count) {
    const std::uint64_t moved = std::min(from, count);
    from -= moved;
    to += moved;
    return count - moved;
  };
  move(counters_.headings, counters_.samples_invalid, headings);
  auto& first = last_twist_was_rejected ? counters_.twists_rejected : counters_.twists_used;
  auto& other = last_twist_was_rejected ? counters_.twists_used : counters_.twists_rejected;
  move(other, counters_.twists_unused, move(first, counters_.twists_unused, twists));
}

/// True if the pose needs only the nominal state.
bool Engine::is_step(const ImuMeasurement& imu) const {
  const double dt_s = seconds_between(state().imu.time_ns, imu.time_ns);
  return state().phase != Phase::waiting && dt_s > 0.0 && dt_s <= settings_.outage.imu_gap_s &&
         !state().is_repetition(imu);
}

FusedPose Engine::pose_after_step(const ImuSample& imu, const ImuMeasurement& measured) const {
  const AdmittedStep next = state().step_to(measured);
  return pose_at(imu, next.sample.rate_body_radps, state().nominal_after(next.step));
}

/// Pose after all consequences of the sample.
FusedPose Engine::whole_pose(const ImuSample& imu) {
  const bool was_in_gap = state().imu.in_gap;
  finish_pending_work();
  FusedPose pose = pose_at(imu, state().imu.rate_body_radps, state().nominal());
  if (state().imu.in_gap) {
    const int repeats = state().imu.repeats.repeats;
    if (repeats == 0 || !was_in_gap) ++counters_.imu_gaps;  // not for each repetition
    if (repeats > RepeatDetector::min_repeats) pose.angular_velocity_body_radps.setZero();  // not measured
    if (state().phase != Phase::waiting) pose.status |= status_imu_gap;
  }
  return pose;
}

bool Engine::admit(const ImuSample& imu) {
  const TimeNs now_ns = time_ns();
  if (!aiding::admission::admits(settings_.admission, now_ns, imu) ||
      aiding::admission::is_time_jump(admission_, now_ns, imu)) {
    ++counters_.samples_invalid;
    if (aiding::admission::needs_time_reset(admission_, now_ns, imu)) reset();
    return false;
  }
  admission_.backward_in_row = 0;
  ++counters_.imu_samples;
  return true;
}

FixReport Engine::correct(const UltrasonicFix& fix) noexcept {
  if (buffer_.has_pending_sample()) finish_pending_work();
  FixReport report = report_on(fix, time_ns());
  report.shifted_position_world_m = fix.position_world_m;
  const FixMeasurement measured = measurement_in(fix);
  report.flags = rejection_flags(fix, measured);
  if (measured.restarts) use_set_yaw(measured, report.flags == 0);
  if (report.flags != 0) {
    ++counters_.fixes_rejected;
    finish_pending_work();  // a late fix leaves the state in the past
    report.trust = state().fixes.trust;
    return report;
  }
  const FixOutcome outcome = buffer_.add(settings_, measured);
  report.flags = outcome.flags;
  report.weight = outcome.weight;
  report.trust = state().fixes.trust;
  report.hypothesis = outcome.hypothesis;
  report.model = state().phase == Phase::tracking ? static_cast<std::uint32_t>(state().bank.best().imu) : 0U;
  if (outcome.has_innovation) {
    report.innovation_world_m = outcome.innovation.value_world_m;
    report.innovation_covariance_m2 = Covariance<3>::from_matrix(outcome.innovation.covariance_m2);
    report.test_ratio = outcome.test_ratio;
    report.shifted_position_world_m = last_position_world_m_ + outcome.innovation.value_world_m;
  }
  report.jump_world_m = outcome.jump_world_m;
  report.velocity_change_world_mps = outcome.velocity_change_world_mps;
  report.yaw_change_rad = outcome.yaw_change_rad;
  if ((outcome.flags & fix_used) != 0) {
    ++counters_.fixes_used;
    last_used_received_ns_ = std::max(last_used_received_ns_, fix.received_time_ns);
    last_delay_s_ = seconds_between(measured.time_ns, fix.received_time_ns);
  } else {
    ++counters_.fixes_rejected;
  }
  return report;
}

/// Uses the yaw of a pose that the user sets, if its fix is used: a refused pose changes nothing.
void Engine::use_set_yaw(const FixMeasurement& fix, bool fix_is_used) {
  constexpr double max_apart_s = 0.1;
  const auto yaw = std::exchange(set_yaw_, std::nullopt);
  if (!yaw) return;
  const bool is_of_fix = std::abs(seconds_between(yaw->time_ns, fix.time_ns)) <= max_apart_s;
  if (fix_is_used && is_of_fix && buffer_.can_insert(yaw->time_ns)) {
    ++counters_.headings;
    buffer_.add(settings_, *yaw);
  } else {
    ++counters_.samples_invalid;
  }
}

ImuMeasurement Engine::measurement_in(const ImuSample& raw) const {
  return as_measurement(calibration_.corrected(raw));
}

FixMeasurement Engine::measurement_in(const UltrasonicFix& fix) const {
  FixMeasurement measured{.time_ns = measured_at(fix),
                          .stamp_ns = stamp_or_none(fix.emission_time_ns),
                          .position_world_m = fix.position_world_m,
                          .quality_percent = fix.quality_percent.value_or(-1.0),
                          .point_body_m = fix.point_body_m,
                          .restarts = (fix.flags & ultrasonic_flag_set_pose) != 0};
  if (measured.restarts && state().phase != Phase::waiting) {
    measured.position_world_m = aiding::admission::completed_position(
        fix, last_position_world_m_ + state().filter().q_body_to_world * fix.point_body_m);
  }
  measured.position_world_m =
      aiding::position_in_plane(settings_.planar, measured.position_world_m, fix.point_body_m);
  if (fix.covariance_world_m2 && is_usable(*fix.covariance_world_m2)) {
    measured.has_covariance = true;
    constexpr double min_m2 = 1e-8;  // 0.1 mm: smaller numbers would no longer be positive
    measured.covariance_world_m2 = fix.covariance_world_m2->matrix() + min_m2 * Matrix3d::Identity();
  }
  constexpr double ignored_m2 = 100.0;
  if (aiding::ignores_height(settings_.planar)) measured.covariance_world_m2(2, 2) += ignored_m2;
  return measured;
}

HeadingMeasurement Engine::measurement_in(const PairHeading& heading) const {
  constexpr double min_std_rad = 0.17 * geometry::radians_per_degree;  // as that which is learned
  constexpr double max_std_rad = std::numbers::pi;                     // no information
  const bool of_body = (heading.flags & heading_flag_of_body) != 0;
  return {.time_ns = measured_at(heading),
          .stamp_ns = stamp_or_none(heading.emission_time_ns),
          .heading_world_rad =
              heading.heading_world_rad +
              (of_body ? settings_.heading.mount_offset_deg * geometry::radians_per_degree : 0.0),
          .std_rad = heading.std_rad >= 0.0 ? std::clamp(heading.std_rad, min_std_rad, max_std_rad) : -1.0,
          .restarts = (heading.flags & heading_flag_set_pose) != 0};
}

template <class Sample>
TimeNs Engine::measured_at(const Sample& sample) const {
  return settings_.delay.extrapolate ? aiding::measured_at(settings_.delay, sample) : time_ns();
}

std::uint32_t Engine::rejection_flags(const UltrasonicFix& fix, const FixMeasurement& measured) const {
  const std::uint32_t flags = aiding::admission::fix_rejection_flags(settings_.admission, time_ns(), fix,
                                                                     measured.time_ns, buffer_.max_ahead_s());
  if (flags != 0) return flags;
  if (buffer_.contains(measured)) return fix_invalid;
  if (buffer_.can_insert(measured.time_ns)) return 0U;
  // Unless the buffer is empty or full, it reaches the present, and the fix is older than all of it.
  return buffer_.can_insert(time_ns()) ? fix_too_late : fix_invalid;
}

void Engine::correct(const PairHeading& heading) noexcept {
  if (buffer_.has_pending_sample()) finish_pending_work();
  const HeadingMeasurement measured = measurement_in(heading);
  if (!aiding::admission::admits(settings_.admission, time_ns(), heading, measured.time_ns,
                                 buffer_.max_ahead_s())) {
    ++counters_.samples_invalid;
    return;
  }
  if (heading.valid && !buffer_.contains(measured) && !buffer_.can_insert(measured.time_ns)) {
    ++counters_.samples_invalid;  // too late
    return;
  }
  if (heading.valid && measured.restarts) {
    set_yaw_ = measured;
    return;
  }
  ++counters_.headings;
  if (!heading.valid || buffer_.contains(measured)) return;
  buffer_.add(settings_, measured);
}

TwistMeasurement Engine::measurement_in(const TwistSample& twist) const {
  static constexpr double min_std_mps = 0.005;
  constexpr double max_std_mps = 1000.0;  // no information
  const settings::TwistSettings& settings = settings_.twist;
  TwistMeasurement measured{.time_ns = measured_at(twist), .stamp_ns = stamp_or_none(twist.emission_time_ns)};
  for (int axis = 0; axis < 3; ++axis) {
    if ((twist.axes & (twist_velocity_x << axis)) == 0) continue;
    const double own_std_mps = twist.velocity_std_mps[axis];
    if (own_std_mps > max_std_mps) continue;
    measured.velocity_body_mps[axis] = twist.velocity_body_mps[axis];
    measured.std_mps[axis] = std::max(own_std_mps >= 0.0 ? own_std_mps : settings.std_mps, min_std_mps);
  }
  const auto constrain = [&measured](int axis, double std_mps) {
    if (measured.std_mps.x() < 0.0 || measured.std_mps[axis] >= 0.0 || std_mps == 0.0) return;
    measured.std_mps[axis] = std::max(std_mps, min_std_mps);
    measured.constrained |= 1 << axis;
  };
  constrain(1, settings.lateral_std_mps);
  constrain(2, settings.vertical_std_mps);
  return measured;
}

void Engine::correct(const TwistSample& twist) noexcept {
  if (buffer_.has_pending_sample()) finish_pending_work();
  const TwistMeasurement measured = measurement_in(twist);
  if (!aiding::admission::is_possible(twist)) {
    ++counters_.samples_invalid;
    return;
  }
  const bool is_admitted = aiding::admission::admits(settings_.admission, time_ns(), twist, measured.time_ns,
                                                     buffer_.max_ahead_s());
  const bool is_measured = measured.std_mps.maxCoeff() >= 0.0;
  if (!is_admitted || !settings_.twist.enabled || !is_measured || state().phase == Phase::waiting ||
      !buffer_.has_place_for_twist() || buffer_.contains(measured) || !buffer_.can_insert(measured.time_ns)) {
    ++counters_.twists_unused;
    return;
  }
  buffer_.add(settings_, measured);
  const bool rejected = state().twist && state().twist->rejected;
  ++(rejected ? counters_.twists_rejected : counters_.twists_used);
}

FusedPose Engine::pose_at(const ImuSample& imu, const Vector3d& rate_body_radps,
                          const NominalState& nominal) const {
  const State& now = state();
  FusedPose pose;
  pose.address = imu.address;
  pose.sequence = imu.sequence;
  pose.time_ns = imu.sensor_time_ns;
  if (now.phase == Phase::waiting) {
    pose.q_body_to_world = geometry::level_with(now.imu.mean_force_body_mps2, 0.0);
    pose.angular_velocity_body_radps = rate_body_radps;
  } else {
    const Filter& filter = now.filter();
    pose.position_world_m = filter.tracked_position_world_m(nominal);
    pose.q_body_to_world = nominal.q_body_to_world;
    pose.velocity_world_mps = filter.tracked_velocity_world_mps(nominal);
    pose.angular_velocity_body_radps = rate_body_radps - filter.gyro_bias_body_radps;
    pose.acceleration_world_mps2 = nominal.acceleration_world_mps2;
    pose.gyro_bias_body_radps = filter.gyro_bias_body_radps;
    pose.pose_covariance = uncertainty_.pose_covariance;
    pose.velocity_covariance = uncertainty_.velocity_covariance;
  }
  pose.trust = now.fixes.trust;
  pose.since_valid_fix_s = last_used_received_ns_ == 0
                               ? std::numeric_limits<double>::infinity()
                               : std::max(0.0, seconds_between(last_used_received_ns_, pose.time_ns));
  pose.reset_counter = reset_counter_;
  pose.status = status(pose.time_ns);
  pose.imu_sensor_time_ns = imu.sensor_time_ns;
  pose.imu_bridge_time_ns = imu.bridge_time_ns;
  return pose;
}

std::uint32_t Engine::status(TimeNs time_ns) const {
  constexpr double low_trust = 0.6;
  constexpr int contradicted_by = 3;  // consecutive headings
  const auto bit = [](bool applies, PoseStatus status) { return applies ? std::uint32_t{status} : 0U; };
  const State& now = state();
  if (now.phase == Phase::waiting) return status_initialising | status_heading_unknown;
  const double since_fix_s = seconds_between(last_used_received_ns_, time_ns);
  return bit(uncertainty_.gyro_bias_is_unknown, status_uncalibrated) |
         bit(since_fix_s > settings_.outage.stale_after_s, status_stale) |
         bit(time_ns < now.converging_until_ns || has_left_track(now), status_converging) |
         bit(uncertainty_.yaw_is_unknown || now.headings.rejected_in_row >= contradicted_by,
             status_heading_unknown) |
         bit(is_distrustful(now.bank.best().imu) || time_ns < now.imu_fault.faulty_until_ns ||
                 uncertainty_.accel_bias_is_large,
             status_imu_inconsistent) |
         bit(now.default_position.is_active(time_ns) || uncertainty_.clocks_differ ||
                 now.fixes.height.is_inconsistent(time_ns),
             status_fixes_inconsistent) |
         bit(now.frozen_track.frozen, status_frozen_track) |
         bit(now.fixes.trust < low_trust, status_low_trust);
}

Estimate Engine::estimate() const {
  Estimate estimate;
  const State& now = state();
  estimate.time_ns = now.imu.time_ns;
  if (now.phase == Phase::waiting) return estimate;
  const Filter& filter = now.filter();
  const auto with_std = [&filter](const Vector3d& value, StateIndex index) {
    return VectorEstimate{.value = value, .std = filter.covariance.diagonal().segment<3>(index).cwiseSqrt()};
  };
  estimate.gyro_bias_body_radps = with_std(filter.gyro_bias_body_radps, at_gyro_bias);
  estimate.accelerometer_bias_body_mps2 = with_std(filter.accel_bias_body_mps2, at_accel_bias);
  estimate.lever_arm_body_m = with_std(filter.lever_arm_body_m, at_lever_arm);
  if (filter.estimates_delay()) {
    estimate.delay_s = ScalarEstimate{.value = last_delay_s_ + filter.delay_error_s,
                                      .std = std::sqrt(filter.delay_variance_s2)};
  }
  const double fix_std_m = std::sqrt(now.noise.fix_covariance_m2(now.fixes.quality_percent)(0, 0));
  estimate.fix_noise_m = ScalarEstimate{.value = fix_std_m, .std = -1.0};
  estimate.heading_noise_rad =
      ScalarEstimate{.value = std::sqrt(now.noise.heading_rad2.variance), .std = -1.0};
  return estimate;
}

}  // namespace sonopose::estimation::kalman
