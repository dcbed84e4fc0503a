#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/estimation/sensor_fault_detector.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace sonopose::estimation {
namespace {

constexpr TimeNs memory_of_fault_ns = 3'000'000'000;
constexpr TimeNs max_step_ns = 200'000'000;  // over a longer gap nothing is integrated

std::complex<double> horizontal(const Vector3d& vector) {
  return {vector.x(), vector.y()};
}

}  // namespace

void SensorFaultDetector::configure(const settings::Settings& settings) {
  delay_ = settings.delay;
  calibration_ = calibration::Calibration(settings.calibration);
  mount_rad_ = settings.heading.mount_offset_deg * geometry::radians_per_degree;
  restart();
}

/// Forgets everything but a fault.
void SensorFaultDetector::restart() {
  last_imu_ns_ = last_pose_ns_ = known_since_ns_ = headings_wrong_ns_ = 0;
  block_ = {};
  bad_blocks_ = wrong_turns_ = right_turns_ = turned_in_row_ = 0;
  force_body_mps2_.setZero();
  turned_rad_ = 0;
  speed_world_mps_ = moved_world_m_ = 0;
  moments_.clear();
  directions_.clear();
  places_.clear();
  lags_ = {};
  product_ = 0;
  imu_square_ = fix_square_ = judged_ = 0;
}

void SensorFaultDetector::fault(TimeNs time_ns) {
  faulty_until_ns_ = time_ns + memory_of_fault_ns;
}

void SensorFaultDetector::on(const Event& event) {
  if (const auto* imu = std::get_if<ImuSample>(&event)) {
    on_imu(*imu);
  } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
    if ((fix->flags & ultrasonic_flag_set_pose) != 0) return;
    if (fix->position_world_m.allFinite()) on_fix(aiding::measured_at(delay_, *fix), *fix);
  } else if (const auto* heading = std::get_if<PairHeading>(&event)) {
    constexpr int min_turns = 2;
    if ((heading->flags & heading_flag_set_pose) != 0) return;
    if (!heading->valid || !std::isfinite(heading->heading_world_rad)) return;
    if (!has_headings_) directions_.clear();  // those of travel
    has_headings_ = true;
    const TimeNs time_ns = aiding::measured_at(delay_, *heading);
    on_direction(time_ns, heading->heading_world_rad, min_turns);
    on_heading(time_ns, heading->heading_world_rad);
    const bool is_of_body = (heading->flags & heading_flag_of_body) != 0;
    judge_mount(time_ns, heading->heading_world_rad - (is_of_body ? 0.0 : mount_rad_));
  }
}

void SensorFaultDetector::on_imu(const ImuSample& raw) {
  constexpr double max_rate_radps = 20.0;
  constexpr double memory_s = 2.0;
  const ImuSample imu = calibration_.corrected(raw);
  const Vector3d& rate = imu.angular_velocity_body_radps;
  const Vector3d& force = imu.specific_force_body_mps2;
  if (!rate.allFinite() || !force.allFinite()) return;
  const TimeNs step_ns = saturated_difference(imu.sensor_time_ns, last_imu_ns_);
  constexpr TimeNs jitter_ns = 1'000'000'000;
  if (step_ns < 0 && step_ns > -jitter_ns) return;
  if (step_ns < 0)
    faulty_until_ns_ = other_clock_until_ns_ = 0;  // otherwise they would outlast a step back of the clock
  if (step_ns < 0 || step_ns > max_step_ns) restart();
  const bool is_first = last_imu_ns_ == 0;
  last_force_body_mps2_ = force;
  last_imu_ns_ = imu.sensor_time_ns;
  const std::array<double, 6> values{raw.angular_velocity_body_radps.x(), raw.angular_velocity_body_radps.y(),
                                     raw.angular_velocity_body_radps.z(), raw.specific_force_body_mps2.x(),
                                     raw.specific_force_body_mps2.y(),    raw.specific_force_body_mps2.z()};
  if (is_first) {
    block_.begin_ns = imu.sensor_time_ns;
    force_body_mps2_ = force;
  } else {
    const double step_s = seconds_between(0, step_ns);
    force_body_mps2_ += std::min(1.0, step_s / memory_s) * (force - force_body_mps2_);
    const double norm_mps2 = force_body_mps2_.norm();
    if (norm_mps2 > 0) turned_rad_ += step_s * rate.dot(force_body_mps2_) / norm_mps2;
    ++block_.samples;
    if (rate.norm() > max_rate_radps) ++block_.fast;
    block_.force_sum_mps2 += force.norm();
    if (bad_blocks_ > 0) {
      block_.q_body_to_begin *= geometry::rotation_by((step_s * rate).eval());
      block_.force_sum_begin_mps2 += block_.q_body_to_begin * force;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] == last_values_[i]) ++block_.repeated[i];
    }
  }
  last_values_ = values;
  judge_block(imu.sensor_time_ns);
}

void SensorFaultDetector::judge_block(TimeNs time_ns) {
  // A fall or a blow is shorter than both. The force of a swinging arm averages out in the longer one.
  constexpr TimeNs min_ns = 1'000'000'000;
  constexpr TimeNs min_suspicious_ns = 2'000'000'000;
  constexpr std::size_t min_samples = 100;
  constexpr double stuck_share = 0.98;
  constexpr double varying_share = 0.2;  // noise alone changes nearly every reading
  constexpr double fast_share = 0.05;
  constexpr double min_force_mps2 = 7.0;
  constexpr double max_force_mps2 = 18.0;
  constexpr int min_bad_blocks = 2;
  const bool is_suspicious = bad_blocks_ > 0;
  if (block_.samples < min_samples ||
      time_ns - block_.begin_ns < (is_suspicious ? min_suspicious_ns : min_ns)) {
    return;
  }
  const auto count = static_cast<double>(block_.samples);
  bool is_faulty = static_cast<double>(block_.fast) > fast_share * count;
  for (const std::size_t first : {std::size_t{0}, std::size_t{3}}) {
    // Two constant axes are those of a sensor that measures in a plane.
    const auto begin = block_.repeated.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, begin + 3);
    is_faulty = is_faulty || (static_cast<double>(begin[2]) >= stuck_share * count &&
                              static_cast<double>(begin[1]) <= varying_share * count);
  }
  const double force_mps2 =
      (is_suspicious ? block_.force_sum_begin_mps2.norm() : block_.force_sum_mps2) / count;
  const bool is_force_possible = force_mps2 > min_force_mps2 && force_mps2 < max_force_mps2;
  bad_blocks_ = is_force_possible ? 0 : std::min(bad_blocks_ + 1, min_bad_blocks);
  if (is_faulty || bad_blocks_ == min_bad_blocks) fault(time_ns);
  block_ = {.begin_ns = time_ns};
}

void SensorFaultDetector::on(const FusedPose& pose) {
  constexpr TimeNs min_step_ns = 4'000'000;  // the ring then holds two seconds
  const TimeNs step_ns = saturated_difference(pose.time_ns, last_pose_ns_);
  last_pose_ns_ = pose.time_ns;
  // Before the heading is known, accelerations have no direction.
  constexpr std::uint32_t unknown = status_initialising | status_heading_unknown;
  if (step_ns < 0 || step_ns > max_step_ns) places_.clear();
  if ((pose.status & unknown) != 0 || step_ns < 0 || step_ns > max_step_ns) {
    known_since_ns_ = pose.time_ns;
    product_ = 0;
    imu_square_ = fix_square_ = judged_ = 0;
  } else {
    const double step_s = seconds_between(0, step_ns);
    // Without the engine's bias, which would take the blame.
    speed_world_mps_ += step_s * horizontal(pose.q_body_to_world * last_force_body_mps2_);
    moved_world_m_ += step_s * speed_world_mps_;
  }
  if (moments_.size() > 0 && pose.time_ns - moments_.back(0).time_ns < min_step_ns) return;
  // The status says that the heading is unknown also where headings contradict a known yaw. Without right
  // fixes the motion shows no yaw.
  constexpr std::uint32_t without_yaw = status_initialising | status_converging | status_stale |
                                        status_frozen_track | status_low_trust | status_fixes_inconsistent;
  constexpr double max_yaw_std_rad = 10.0 * geometry::radians_per_degree;
  const double yaw_std = yaw_std_rad(pose);
  const bool has_yaw = (pose.status & without_yaw) == 0 && yaw_std >= 0 && yaw_std < max_yaw_std_rad;
  const Vector3d x_world = pose.q_body_to_world * Vector3d::UnitX();
  moments_.add({pose.time_ns, turned_rad_, moved_world_m_, has_yaw ? horizontal(x_world) : 0.0});
}

/// Interpolates the integrals. Returns false outside of the moments.
bool SensorFaultDetector::moment_at(TimeNs time_ns, Moment& moment) const {
  for (std::size_t i = 0; i + 1 < moments_.size(); ++i) {
    const Moment& after = moments_.back(i);
    const Moment& before = moments_.back(i + 1);
    if (time_ns > after.time_ns) return false;
    if (time_ns < before.time_ns || after.time_ns == before.time_ns) continue;
    const double share =
        seconds_between(before.time_ns, time_ns) / seconds_between(before.time_ns, after.time_ns);
    moment.time_ns = time_ns;
    moment.turned_rad = before.turned_rad + share * (after.turned_rad - before.turned_rad);
    moment.moved_world_m = before.moved_world_m + share * (after.moved_world_m - before.moved_world_m);
    moment.facing_world = before.facing_world + share * (after.facing_world - before.facing_world);
    return true;
  }
  return false;
}

void SensorFaultDetector::on_fix(TimeNs time_ns, const UltrasonicFix& fix) {
  constexpr double step_s = 0.4;
  constexpr double max_step_s = 1.0;
  constexpr double min_step_m = 0.2;  // well above the noise of fixes
  constexpr int min_turns = 3;        // not every body faces where it goes
  constexpr TimeNs tag_lost_ns = 1'000'000'000;
  if (fix.point_body_m != tag_body_m_) {  // two tags do not move alike
    if (std::abs(saturated_difference(time_ns, tag_seen_ns_)) < tag_lost_ns) return;
    tag_body_m_ = fix.point_body_m;
    places_.clear();
    if (!has_headings_) directions_.clear();
  }
  tag_seen_ns_ = time_ns;
  Moment moment;
  if (!moment_at(time_ns, moment)) return;
  const Place place{time_ns, horizontal(fix.position_world_m), moment.moved_world_m};
  if (places_.size() > 0 && time_ns <= places_.back(0).time_ns) return;
  places_.add(place);
  on_place(place);
  if (has_headings_) return;
  for (std::size_t i = 1; i < places_.size(); ++i) {
    const Place& from = places_.back(i);
    const double length_s = seconds_between(from.time_ns, time_ns);
    if (length_s > max_step_s) return;
    if (length_s < step_s) continue;
    const std::complex<double> moved_m = place.position_world_m - from.position_world_m;
    if (std::abs(moved_m) >= min_step_m)
      on_direction(from.time_ns + (time_ns - from.time_ns) / 2, std::arg(moved_m), min_turns);
    return;
  }
}

/// Compares the change of speed by the fixes with that by the IMU. With a turned mount they have the same
/// size and another direction.
void SensorFaultDetector::on_place(const Place& last) {
  constexpr double step_s = 0.5;
  constexpr double max_step_s = 0.8;
  constexpr double memory = 0.96;  // two to three seconds of fixes
  constexpr double min_judged = 12.0;
  constexpr double min_change_mps = 0.25;  // RMS, above the noise of fixes
  constexpr double min_coherence = 0.8;
  constexpr int min_in_row = 8;
  constexpr double min_ratio = 0.5;
  constexpr double wrong_angle_rad = 55.0 * geometry::radians_per_degree;
  const Place* middle = nullptr;
  for (std::size_t i = 1; i < places_.size(); ++i) {
    const Place& place = places_.back(i);
    const Place& next = middle == nullptr ? last : *middle;
    const double length_s = seconds_between(place.time_ns, next.time_ns);
    if (length_s < step_s) continue;
    if (length_s > max_step_s || place.time_ns < known_since_ns_) return;
    if (middle == nullptr) {
      middle = &place;
      continue;
    }
    const auto change = [&](std::complex<double> Place::*member) {
      return (last.*member - middle->*member) / seconds_between(middle->time_ns, last.time_ns) -
             (middle->*member - place.*member) / length_s;
    };
    const std::complex<double> by_fixes_mps = change(&Place::position_world_m);
    const std::complex<double> by_imu_mps = change(&Place::moved_world_m);
    product_ = memory * product_ + std::conj(by_imu_mps) * by_fixes_mps;
    imu_square_ = memory * imu_square_ + std::norm(by_imu_mps);
    fix_square_ = memory * fix_square_ + std::norm(by_fixes_mps);
    judged_ = memory * judged_ + 1.0;
    break;
  }
  if (judged_ < min_judged || fix_square_ < judged_ * min_change_mps * min_change_mps) return;
  const double product = std::abs(product_);
  const bool is_coherent = product > min_coherence * std::sqrt(imu_square_ * fix_square_) &&
                           product > min_ratio * imu_square_ && product > min_ratio * fix_square_;
  const bool is_turned = is_coherent && std::abs(std::arg(product_)) > wrong_angle_rad;
  turned_in_row_ = is_turned ? turned_in_row_ + 1 : 0;
  if (turned_in_row_ >= min_in_row) fault(last.time_ns);
}

/// Adds a direction, and judges the latest turn that is large and smooth enough.
void SensorFaultDetector::on_direction(TimeNs time_ns, double angle_rad, int min_turns) {
  constexpr double min_s = 0.5;
  constexpr double max_s = 2.0;
  constexpr double max_gap_s = 0.6;
  constexpr double min_turn_rad = 30.0 * geometry::radians_per_degree;
  Moment moment;
  if (!moment_at(time_ns, moment)) return;
  const bool is_first = directions_.size() == 0;
  if (!is_first && time_ns <= directions_.back(0).time_ns) return;
  if (!is_first && seconds_between(directions_.back(0).time_ns, time_ns) > max_gap_s) directions_.clear();
  const double before_rad = directions_.size() == 0 ? angle_rad : directions_.back(0).direction_rad;
  const Direction now{time_ns, before_rad + geometry::wrap_angle(angle_rad - before_rad), moment.turned_rad};
  directions_.add(now);
  for (std::size_t i = 1; i < directions_.size(); ++i) {
    const Direction& from = directions_.back(i);
    const double length_s = seconds_between(from.time_ns, time_ns);
    if (length_s > max_s) return;
    if (length_s < min_s || std::abs(now.direction_rad - from.direction_rad) < min_turn_rad) continue;
    judge_turn(from, directions_.back(i / 2), now, min_turns);
    directions_.clear();  // the next turn begins here
    directions_.add(now);
    return;
  }
}

/// Suspects another clock if the gyroscope turns as the headings do, but at another time.
void SensorFaultDetector::on_heading(TimeNs time_ns, double heading_rad) {
  constexpr TimeNs step_ns = 100'000'000;
  constexpr double gain = 1.0 / 32.0;
  constexpr double min_count = 30.0;
  constexpr double max_std_rad = 5.0 * geometry::radians_per_degree;
  constexpr double min_ratio = 3.0;  // of the deviations
  constexpr int min_lags = 2;
  heading_rad_ += geometry::wrap_angle(heading_rad - heading_rad_);
  const Lag* best = nullptr;
  for (int lag = -max_lags; lag <= max_lags; ++lag) {
    const int index = lag + max_lags;
    Lag& each = lags_.at(static_cast<std::size_t>(index));
    Moment moment;
    if (!moment_at(time_ns + lag * step_ns, moment)) {
      each = {};
      continue;
    }
    const double deviation_rad = heading_rad_ - moment.turned_rad - each.mean_rad;
    each.count += 1.0;
    const double share = std::max(gain, 1.0 / each.count);
    each.mean_rad += share * deviation_rad;
    each.variance_rad2 = (1.0 - share) * (each.variance_rad2 + share * deviation_rad * deviation_rad);
    if (each.count < min_count) continue;
    if (best == nullptr || each.variance_rad2 < best->variance_rad2) best = &each;
  }
  const Lag& none = lags_[max_lags];
  if (best == nullptr || none.count < min_count || std::abs(best - &none) < min_lags) return;
  if (best->variance_rad2 > max_std_rad * max_std_rad) return;
  if (none.variance_rad2 < min_ratio * min_ratio * best->variance_rad2) return;
  other_clock_until_ns_ = last_imu_ns_ + memory_of_fault_ns;
}

/// Suspects the mount if headings keep contradicting a pose whose yaw is known from the motion.
void SensorFaultDetector::judge_mount(TimeNs time_ns, double body_heading_rad) {
  constexpr double wrong_rad = 30.0 * geometry::radians_per_degree;
  constexpr double min_s = 3.0;
  constexpr double max_gap_s = 1.0;
  constexpr double min_level = 0.5;  // a body that looks up or down has no heading
  Moment moment;
  if (!moment_at(time_ns, moment)) return;
  const double error_rad = std::arg(std::polar(1.0, body_heading_rad) * std::conj(moment.facing_world));
  const bool is_wrong = std::abs(moment.facing_world) > min_level && std::abs(error_rad) > wrong_rad;
  const bool continues = seconds_between(last_heading_ns_, time_ns) < max_gap_s;
  last_heading_ns_ = time_ns;
  if (!is_wrong) {
    headings_wrong_ns_ = 0;
  } else if (headings_wrong_ns_ == 0 || !continues) {
    headings_wrong_ns_ = time_ns;
  } else if (seconds_between(headings_wrong_ns_, time_ns) > min_s) {
    fault(time_ns);
  }
}

void SensorFaultDetector::judge_turn(const Direction& from, const Direction& middle, const Direction& to,
                                     int min_turns) {
  constexpr double max_bend = 0.35;  // a half for a jump, as by outliers
  constexpr double wrong_gain = -0.6;
  constexpr double min_gain = -20.0;  // of rates in deg/s
  constexpr double right_gain = 0.5;
  constexpr int max_right_turns = 3;
  const double turn_rad = to.direction_rad - from.direction_rad;
  const double share =
      seconds_between(from.time_ns, middle.time_ns) / seconds_between(from.time_ns, to.time_ns);
  const double bend_rad = middle.direction_rad - from.direction_rad - share * turn_rad;
  if (std::abs(bend_rad) > max_bend * std::abs(turn_rad)) return;
  const double gain = (to.turned_rad - from.turned_rad) / turn_rad;
  wrong_turns_ = gain < wrong_gain && gain > min_gain ? wrong_turns_ + 1 : 0;
  // A sign does not change: after right turns, fixes that drift are more likely.
  if (gain > right_gain) right_turns_ = std::min(right_turns_ + 1, max_right_turns);
  if (wrong_turns_ >= min_turns + right_turns_) fault(to.time_ns);
}

}  // namespace sonopose::estimation
