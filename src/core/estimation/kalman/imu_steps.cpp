#include <sonopose/estimation/kalman/imu_steps.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

bool is_equal(const ImuMeasurement& last, const ImuMeasurement& sample) {
  return last.rate_body_radps == sample.rate_body_radps && last.force_body_mps2 == sample.force_body_mps2;
}

}  // namespace

double nominal_imu_period_s(double before_s, double step_s) {
  constexpr double smoothing_factor = 1.0 / 32.0;
  constexpr double max_growth = 1.1;  // a gap counts little
  if (!(before_s > 0.0)) return step_s;
  return before_s + smoothing_factor * (std::min(step_s, max_growth * before_s) - before_s);
}

Vector3d ShockDetector::add(const Vector3d& step_reading_body, double duration_s, double smooth) {
  constexpr double interval_s = 0.0075;       // one sample at 100 Hz, several of a faster IMU
  constexpr double smooth_interval_s = 0.01;  // a slower IMU sees more of a smooth motion
  constexpr double share_of_shock = 2.0;
  constexpr double rough_factor = 2.5;
  constexpr double memory_s = 1.0;
  open_s += duration_s;
  open_integral_body += duration_s * step_reading_body;
  if (open_s < interval_s) return Vector3d::Zero();
  const Vector3d latest = open_integral_body / open_s;
  const Vector3d change = latest - 2.0 * reading_body[1] + reading_body[0];
  const double difference = intervals < 2 ? 0.0 : change.norm();
  const double smooth_here =
      smooth * std::max(1.0, open_s * open_s / (smooth_interval_s * smooth_interval_s));
  const double usual = std::max(smooth_here, rough_factor * roughness);
  const double excess_share = difference > usual ? 1.0 - usual / difference : 0.0;
  const Vector3d error = share_of_shock * open_s * excess_share * change;
  // A shock counts little; the limit grows slowly under constant vibration.
  roughness += std::min(1.0, open_s / memory_s) * (std::min(difference, usual) - roughness);
  reading_body = {reading_body[1], latest};
  intervals = std::min(intervals + 1, 2);
  open_s = 0.0;
  open_integral_body.setZero();
  return error;
}

double ShockDetector::density_rthz() const {
  constexpr double of_white_noise = 3.9;  // mean second difference of three axes, in standard deviations
  constexpr double usual_interval_rts = 0.1;
  return roughness / of_white_noise * usual_interval_rts;
}

SpikeFilter::Output SpikeFilter::add(const Vector3d& last_body, const Vector3d& reading_body,
                                     double duration_s, double max_jump) {
  constexpr double max_held_s = 0.0455;  // four samples at 100 Hz
  constexpr double returned_share = 0.5;
  constexpr double gradual_share = 0.75;  // a sensor filters its signal: even a shock takes some samples
  constexpr double rare_factor = 3.0;     // vibration jumps again and again
  constexpr double fading_s = 0.5;
  constexpr double usual_step_s = 0.01;  // over a longer step a body changes more
  const Vector3d excess_body = reading_body - last_body;
  const double jump = excess_body.norm();
  const double limit =
      std::max(max_jump * std::max(1.0, duration_s / usual_step_s), rare_factor * recent_jump);
  const bool is_held = held_s > 0.0;
  const bool continues = is_held && !(jump < returned_share * largest_jump);
  const bool begins = !is_held && jump > limit;
  Output output{.reading_body = reading_body};
  if (duration_s == 0.0) {  // a repeated stamp: nothing is integrated
    if (begins || is_held) output.reading_body = last_body;
    return output;
  }
  recent_jump = std::max(jump, std::exp(-duration_s / fading_s) * recent_jump);
  largest_jump = std::max(largest_jump, jump);
  largest_change = std::max(largest_change, (reading_body - (is_held ? held_body : last_body)).norm());
  const bool is_gradual = largest_change < gradual_share * largest_jump;
  if ((begins || continues) && !is_gradual && held_s + duration_s <= max_held_s) {
    held_s += duration_s;
    excess_double_integral_body += duration_s * (excess_integral_body + 0.5 * duration_s * excess_body);
    excess_integral_body += duration_s * excess_body;
    output.reading_body = last_body;
    held_body = reading_body;
    return output;
  }
  if (continues) {
    output.made_up_body = excess_integral_body;
    output.made_up_shift_body = excess_double_integral_body;
  } else {
    output.dropped_body = excess_integral_body;
  }
  forget_held();
  return output;
}

Vector3d ClipDetector::add(const Vector3d& reading_body_radps) {
  constexpr double min_range_radps = 2.0;  // the smallest range of a usual gyroscope is 125 °/s
  constexpr double min_repeats = 2;        // noise repeats a value by chance
  constexpr double max_repeats = 1000;
  constexpr double missed_share = 0.3;
  Vector3d missed_radps = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double magnitude = std::abs(reading_body_radps[i]);
    repeats[i] = magnitude == largest_body_radps[i] ? std::min(repeats[i] + 1.0, max_repeats) : 0.0;
    largest_body_radps[i] = std::max(largest_body_radps[i], magnitude);
    if (repeats[i] >= min_repeats && magnitude > min_range_radps) missed_radps[i] = missed_share * magnitude;
  }
  return missed_radps;
}

bool RepeatDetector::repeats_with(const ImuMeasurement& last, const ImuMeasurement& sample) const {
  constexpr double max_share = 0.5;
  return repeats >= min_repeats && is_equal(last, sample) &&
         std::max(equal_rates.maxCoeff(), equal_forces.maxCoeff()) < max_share;
}

void RepeatDetector::add(const ImuMeasurement& last, const ImuMeasurement& sample) {
  static constexpr double smoothing_factor = 0.01;
  constexpr int max_repeats = 1000;
  const bool is_repetition = repeats_with(last, sample);
  repeats = is_equal(last, sample) ? std::min(repeats + 1, max_repeats) : 0;
  if (is_repetition) return;  // it says nothing of the noise
  const auto update = [](Vector3d& shares, const Vector3d& before, const Vector3d& now) {
    shares += smoothing_factor * ((before.array() == now.array()).cast<double>().matrix() - shares);
  };
  update(equal_rates, last.rate_body_radps, sample.rate_body_radps);
  update(equal_forces, last.force_body_mps2, sample.force_body_mps2);
}

ImuStep step_between(const ImuMeasurement& last, const ImuMeasurement& next, double usual_s) {
  constexpr double short_s = 0.0275;
  constexpr double regular_steps = 1.5;
  const double regular_step_s = std::max(short_s, regular_steps * usual_s);
  const double dt_s = seconds_between(last.time_ns, next.time_ns);
  if (next.is_mean) return {dt_s, next.rate_body_radps, next.force_body_mps2};
  ImuStep step{dt_s, 0.5 * (last.rate_body_radps + next.rate_body_radps),
               0.5 * (last.force_body_mps2 + next.force_body_mps2)};
  if (!(dt_s > regular_step_s)) return step;
  // The mean of the two ends differs from that between them.
  step.irregular = true;
  step.velocity_std_mps = dt_s * (0.3 * (next.force_body_mps2 - last.force_body_mps2).norm() + 0.3);
  step.position_std_m = 0.5 * step.velocity_std_mps * dt_s;
  step.attitude_std_rad = dt_s * (0.3 * (next.rate_body_radps - last.rate_body_radps).norm() + 0.03);
  return step;
}

void ImuPreintegrator::add(const ImuStep& step) {
  const Vector3d turn_rad = step.duration_s * step.rate_body_radps + step.made_up_turn_body_rad;
  const Vector3d impulse_mps = step.duration_s * step.force_body_mps2 + step.made_up_impulse_body_mps;
  coning_rad_ += 0.5 * turn_rad_.cross(turn_rad);
  sculling_mps_ += 0.5 * (turn_rad_.cross(impulse_mps) + impulse_mps_.cross(turn_rad));
  turn_rad_ += turn_rad;
  impulse_mps_ += impulse_mps;
  shift_m_ += step.made_up_shift_body_m;
  duration_s_ += step.duration_s;
  latest_ = step;
}

ImuStep ImuPreintegrator::joined() const {
  if (!joined_differs()) return latest_;
  const double per_s = 1.0 / duration_s_;
  return {.duration_s = duration_s_,
          .rate_body_radps = per_s * (turn_rad_ + coning_rad_),
          .force_body_mps2 = per_s * (impulse_mps_ + sculling_mps_),
          .made_up_shift_body_m = shift_m_};
}

}  // namespace sonopose::estimation::kalman
