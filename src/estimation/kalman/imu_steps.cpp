#include <sonopose/estimation/kalman/imu_steps.hpp>

#include <algorithm>

namespace sonopose::estimation::kalman {

double usual_step_s(double before_s, double step_s) {
  constexpr double share = 1.0 / 32.0;
  constexpr double most_growth = 1.1;  // a gap counts little
  if (!(before_s > 0.0)) return step_s;
  return before_s + share * (std::min(step_s, most_growth * before_s) - before_s);
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
  latest_ = step;
}

ImuStep JoinedSteps::joined() const {
  if (!has_several()) return latest_;
  const double per_s = 1.0 / duration_s_;
  return {duration_s_, per_s * (turn_rad_ + coning_rad_), per_s * (impulse_mps_ + sculling_mps_)};
}

}  // namespace sonopose::estimation::kalman
