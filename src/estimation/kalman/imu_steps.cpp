#include <sonopose/estimation/kalman/imu_steps.hpp>

#include <algorithm>

namespace sonopose::estimation::kalman {

double usual_step_s(double before_s, double step_s) {
  constexpr double share = 1.0 / 32.0;
  constexpr double most_growth = 1.1;  // a gap counts little
  if (!(before_s > 0.0)) return step_s;
  return before_s + share * (std::min(step_s, most_growth * before_s) - before_s);
}

double ShockDetector::add(const Vector3d& step_body_mps2, double duration_s) {
  constexpr double interval_s = 0.0075;  // a sample at 100 Hz, several of a faster IMU
  constexpr double smooth_mps2 = 2.5;    // second difference of the motion of a body
  constexpr double share_of_shock = 2.0;
  constexpr double rough_factor = 2.5;
  constexpr double memory_s = 1.0;
  open_s += duration_s;
  open_impulse_body_mps += duration_s * step_body_mps2;
  if (open_s < interval_s) return 0.0;
  const Vector3d latest = open_impulse_body_mps / open_s;
  const double difference_mps2 =
      intervals < 2 ? 0.0 : (latest - 2.0 * force_body_mps2[1] + force_body_mps2[0]).norm();
  const double usual_mps2 = std::max(smooth_mps2, rough_factor * roughness_mps2);
  const double std_mps = share_of_shock * std::max(0.0, difference_mps2 - usual_mps2) * open_s;
  // A shock counts little: the limit grows slowly with what vibrates all the time.
  roughness_mps2 +=
      std::min(1.0, open_s / memory_s) * (std::min(difference_mps2, usual_mps2) - roughness_mps2);
  force_body_mps2 = {force_body_mps2[1], latest};
  intervals = std::min(intervals + 1, 2);
  open_s = 0.0;
  open_impulse_body_mps.setZero();
  return std_mps * std_mps;
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
  // The mean of the two ends is not that of what lies between.
  step.irregular = true;
  step.velocity_std_mps = dt_s * (0.3 * (next.force_body_mps2 - last.force_body_mps2).norm() + 0.3);
  step.position_std_m = 0.5 * step.velocity_std_mps * dt_s;
  step.attitude_std_rad = dt_s * (0.3 * (next.rate_body_radps - last.rate_body_radps).norm() + 0.03);
  return step;
}

void JoinedSteps::add(const ImuStep& step) {
  const Vector3d turn_rad = step.duration_s * step.rate_body_radps;
  const Vector3d impulse_mps = step.duration_s * step.force_body_mps2;
  coning_rad_ += 0.5 * turn_rad_.cross(turn_rad);
  sculling_mps_ += 0.5 * (turn_rad_.cross(impulse_mps) + impulse_mps_.cross(turn_rad));
  turn_rad_ += turn_rad;
  impulse_mps_ += impulse_mps;
  duration_s_ += step.duration_s;
  shock_variance_m2ps2_ += step.shock_variance_m2ps2;
  latest_ = step;
}

ImuStep JoinedSteps::joined() const {
  if (!has_several()) return latest_;
  const double per_s = 1.0 / duration_s_;
  return {.duration_s = duration_s_,
          .rate_body_radps = per_s * (turn_rad_ + coning_rad_),
          .force_body_mps2 = per_s * (impulse_mps_ + sculling_mps_),
          .shock_variance_m2ps2 = shock_variance_m2ps2_};
}

}  // namespace sonopose::estimation::kalman
