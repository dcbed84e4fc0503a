#include "evaluation/score/baseline.hpp"

namespace sonopose::evaluation {

void Baseline::on(const UltrasonicFix& fix) {
  if (latest_ && fix.emission_time_ns <= latest_->emission_time_ns) return;
  before_ = latest_;
  latest_ = fix;
}

std::optional<Vector3d> Baseline::last_fix() const {
  if (!latest_) return std::nullopt;
  return latest_->position_world_m;
}

std::optional<Vector3d> Baseline::extrapolated(TimeNs time_ns) const {
  constexpr double max_gap_s = 0.5;
  if (!latest_ || !before_) return last_fix();
  const double interval_s = seconds_between(before_->emission_time_ns, latest_->emission_time_ns);
  if (interval_s > max_gap_s) return last_fix();
  const Vector3d velocity_world_mps = (latest_->position_world_m - before_->position_world_m) / interval_s;
  return latest_->position_world_m + velocity_world_mps * seconds_between(latest_->emission_time_ns, time_ns);
}

}  // namespace sonopose::evaluation
