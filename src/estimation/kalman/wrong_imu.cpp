// An IMU that contradicts fixes and headings: models that hardly trust one of its sensors.

#include "estimation/kalman/belief_parts.hpp"

#include <algorithm>

namespace sonopose::estimation::kalman {

/// Adds a fix to what each explanation says of the recent ones.
void Belief::explain(const FixMeasurement& fix, const Matrix3d& covariance, const Innovations& innovations,
                     double ahead_s) {
  constexpr double kept = 0.85;
  const double of_best = std::max(log_likelihood_or_wrong(innovations[static_cast<std::size_t>(best)]),
                                  explanations.of_noise(innovations[static_cast<std::size_t>(best)]));
  const double of_shift = explanations.of_shift(
      fix.time_ns, innovations[static_cast<std::size_t>(best)].value_world_m, covariance);
  const double of_rival = rival.alive
                              ? std::max(of_shift, log_likelihood_or_wrong(rival.filter.fix_innovation(
                                                       fix.position_world_m, covariance, ahead_s)))
                              : std::max(of_best, of_shift);
  if (!rival.alive) explanations.rival = explanations.best;  // it would begin as the best filter
  explanations.best = kept * explanations.best + of_best;
  explanations.rival = kept * explanations.rival + of_rival;
  if (has_open_models()) {
    explanations.gyro = kept * explanations.gyro + log_likelihood_or_wrong(innovations[open_gyro]);
    explanations.accel = kept * explanations.accel + log_likelihood_or_wrong(innovations[open_accel]);
  }
}

/// Lets the open models begin where fixes or headings fit badly, and ends them after a while without such.
void Belief::suspect_imu(bool is_suspicious) {
  constexpr TimeNs kept_ns = 2'000'000'000;
  if (is_suspicious) suspicious_until_ns = state_ns + kept_ns;
  if (phase != Phase::tracking || is_open(best)) return;
  if (has_open_models()) {
    if (state_ns > suspicious_until_ns) candidate_count = closed_count;
    return;
  }
  if (state_ns > suspicious_until_ns) return;
  candidate_count = model_count;
  explanations.gyro = explanations.accel = explanations.best;
  // What was wrong has been so for some tenths of a second.
  for (const int model : {open_gyro, open_accel}) {
    Candidate& candidate = candidates[static_cast<std::size_t>(model)];
    candidate = candidates[static_cast<std::size_t>(best)];
    candidate.filter.add_variance(at_velocity, Vector3d::Constant(square(0.2)));
  }
  Filter& gyro = candidates[open_gyro].filter;
  gyro.add_variance(at_attitude, Vector3d::Constant(square(radians(2.0))));
  gyro.add_yaw_variance(square(radians(10.0)));
  gyro.add_variance(at_gyro_bias, Vector3d::Constant(square(0.3)));
  candidates[open_accel].filter.add_variance(at_accel_bias, Vector3d::Constant(square(1.0)));
}

/// Corrects the open models by a fix that the best one rejects.
void Belief::correct_open(const Innovations& innovations, const Matrix3d& covariance) {
  if (!has_open_models()) return;
  for (const int model : {open_gyro, open_accel}) {
    const Innovation& innovation = innovations[static_cast<std::size_t>(model)];
    if (model == best || !(innovation.squared_norm <= rejected_above)) continue;
    candidates[static_cast<std::size_t>(model)].filter.correct_fix(innovation,
                                                                   (scale_of(innovation) - 1.0) * covariance);
  }
}

/// The open model of the sensor whose error explains the recent fixes and headings better than everything
/// else; else the best model.
int Belief::wrong_sensor() const {
  constexpr double advantage = 8.0;
  constexpr int least_rejected = 4;
  if (phase != Phase::tracking || !has_open_models() ||
      std::max(fixes_rejected_in_row, headings_rejected_in_row) < least_rejected)
    return best;
  const double needed = std::max(explanations.best, explanations.rival) + advantage;
  const bool is_gyro = explanations.gyro > explanations.accel;
  return std::max(explanations.gyro, explanations.accel) > needed ? (is_gyro ? open_gyro : open_accel) : best;
}

/// Continues with this open model.
void Belief::doubt_imu(int model) {
  constexpr double memory_s = 60.0;
  if (!former.alive || former.is_anchor) keep_former(state_ns, state_ns);
  imu_doubts =
      imu_doubted_ns != 0 && seconds_between(imu_doubted_ns, state_ns) < memory_s ? imu_doubts + 1 : 1;
  imu_doubts = std::min(imu_doubts, 100);
  imu_doubted_ns = state_ns;
  imu_doubted_until_ns = state_ns + doubt_ns;
  if (!is_open(best)) {
    trusted_gyro_bias_body_radps = filter().gyro_bias_body_radps;
    trusted_accel_bias_body_mps2 = filter().accel_bias_body_mps2;
  }
  candidates[static_cast<std::size_t>(model)].score = candidates[static_cast<std::size_t>(best)].score;
  best = model;
  for (int i = 0; i < candidate_count; ++i) {
    if (i != best) clone_best(candidates[static_cast<std::size_t>(i)]);
  }
  rival.alive = false;
  heading_rejected_since_ns = 0;
  headings_rejected_in_row = 0;
  rest::restart(rest);
}

/// Lets a candidate begin again as the best one. If that is an open model, it trusts the IMU as before the
/// doubt.
void Belief::clone_best(Candidate& candidate) {
  constexpr double handicap = 2.0;
  const Candidate& chosen = candidates[static_cast<std::size_t>(best)];
  candidate = {.filter = chosen.filter, .score = chosen.score - handicap};
  if (!is_open(best)) return;
  Filter& f = candidate.filter;
  f.gyro_bias_body_radps = trusted_gyro_bias_body_radps;
  f.accel_bias_body_mps2 = trusted_accel_bias_body_mps2;
  f.decorrelate(at_gyro_bias, Vector3d::Constant(square(start_gyro_bias_std_radps)));
  f.decorrelate(at_accel_bias, Vector3d::Constant(square(start_accel_bias_std_mps2)));
}

/// True if a candidate has explained enough fixes and headings; each doubt doubles their number.
bool Belief::trusts_imu_again(const Candidate& candidate) const {
  constexpr int least = 20;
  return candidate.explained_in_row >= least << std::min(imu_doubts, 4) &&
         candidate.score > candidates[static_cast<std::size_t>(best)].score;
}

}  // namespace sonopose::estimation::kalman
