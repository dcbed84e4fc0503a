// The models of the process noise: each is corrected by a fix, and their likelihoods choose the best.

#include "estimation/kalman/belief_parts.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {

void Belief::correct_candidates(const FixMeasurement& fix, const Matrix3d& covariance,
                                const Matrix3d& more_covariance, const Innovations& innovations,
                                double ahead_s) {
  constexpr double forgetting = 1.0 / 60.0;
  for (int i = 0; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    const Innovation& innovation = innovations[static_cast<std::size_t>(i)];
    if (phase == Phase::tracking) candidate.score *= 1.0 - forgetting;
    candidate.score += log_likelihood(innovation);
    const bool rejected = innovation.squared_norm > 2.0 * rejected_above;
    candidate.rejected_in_row = rejected ? candidate.rejected_in_row + 1 : 0;
    candidate.explained_in_row =
        innovation.squared_norm <= explained_below ? std::min(candidate.explained_in_row + 1, 10000) : 0;
    if (!rejected) candidate.filter.correct_fix(innovation, more_covariance);
  }
  if (phase == Phase::searching_yaw) {
    prune_starts();
    return;
  }
  choose_model();
  if (fix.has_covariance || is_open(best)) return;  // an error of the motion would count as noise
  correlation.add(innovations[static_cast<std::size_t>(best)]);
  const Innovation after = filter().fix_innovation(fix.position_world_m, covariance, ahead_s);
  noise.add_fix(fix.quality_percent, std::sqrt(correlation.white_share()) * after.value_world_m,
                (after.covariance_m2 - covariance).diagonal(), stands_still(few_fixes));
}

void Belief::choose_model() {
  constexpr double noisier = 1.0;
  constexpr double quieter = 3.0;      // to trust an IMU too much costs more than to trust it too little
  constexpr double most_behind = 8.0;  // the noise may change at any time
  constexpr int lost_after = 6;
  for (int i = 0; i < candidate_count; ++i) {
    const Candidate& chosen = candidates[static_cast<std::size_t>(best)];
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (i != best && candidate.rejected_in_row >= lost_after) clone_best(candidate);
    if (is_open(i)) continue;
    if (is_open(best) ? trusts_imu_again(candidate)
                      : candidate.score > chosen.score + (i > best ? noisier : quieter))
      best = i;
  }
  const double most = candidates[static_cast<std::size_t>(best)].score;
  for (int i = best + 1; i < candidate_count; ++i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    candidate.score = std::max(candidate.score, most - most_behind);
  }
  if (is_open(best)) imu_doubted_until_ns = state_ns + doubt_ns;
}

}  // namespace sonopose::estimation::kalman
