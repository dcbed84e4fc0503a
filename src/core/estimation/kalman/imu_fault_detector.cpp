// Choice among the models of the IMU, and detection of its faults where fixes and headings contradict it.

#include "estimation/kalman/filter_internal.hpp"
#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

constexpr TimeNs fault_memory_ns = 3'000'000'000;  // an IMU that was wrong a moment ago may be wrong again

/// Turns a filter about the vertical through the tracked point.
void turn_to(Filter& filter, double yaw_rad) {
  const Vector3d tracked_world_m = filter.tracked_position_world_m();
  filter.q_body_to_world = geometry::level_with(geometry::up_in_body(filter.q_body_to_world), yaw_rad);
  filter.position_world_m = tracked_world_m + filter.q_body_to_world * filter.lever_arm_body_m;
}

/// Restarts a hypothesis from the best one. If that is distrustful, the new one trusts the IMU as before the
/// fault, and one without headings tries another yaw.
void restart(Hypothesis& hypothesis, const Hypothesis& best, const State& state) {
  constexpr double restart_penalty = 2.0;
  constexpr double next_yaw_rad = radians(135.0);  // reaches eight directions in turn
  const ImuModel model = hypothesis.imu;
  const double failed_yaw_rad = geometry::yaw_of(hypothesis.filter.q_body_to_world);
  hypothesis = best;
  set_imu_model(hypothesis, model);
  hypothesis.score -= restart_penalty;
  hypothesis.missed_in_row = hypothesis.explained_in_row = 0;
  if (!is_distrustful(best.imu) || is_distrustful(model)) return;
  restore_trusted_biases(state.imu_fault, hypothesis.filter);
  if (best.imu == ImuModel::distrusts_imu || model == ImuModel::wrong_headings)
    level_by_mean_force(state, hypothesis.filter);
  if (model != ImuModel::wrong_headings) return;
  turn_to(hypothesis.filter, failed_yaw_rad + next_yaw_rad);
  hypothesis.filter.add_yaw_variance(square(radians(20.0)));
}

/// True if it has explained enough fixes in a row to trust the IMU again; each fault doubles their number.
bool trusts_imu_again(const Hypothesis& hypothesis, const State& state) {
  constexpr int min_explained = 20;
  // Wrong headings are no fault of the IMU, and their offset must prove itself besides.
  const int faults = hypothesis.imu == ImuModel::wrong_headings ? 1 : std::min(state.imu_fault.faults, 4);
  return hypothesis.explained_in_row >= min_explained << faults && hypothesis.score > state.bank.best().score;
}

/// True if the clocks of IMU and fixes certainly differ.
bool has_other_clock(const Filter& filter) {
  constexpr double sigmas = 6.0;
  return square(filter.delay_error_s) > square(sigmas) * filter.delay_variance_s2;
}

/// True if a model may be chosen by its score.
bool may_be_best(const State& state, const Hypothesis& hypothesis) {
  const bool best_is_distrustful = is_distrustful(state.bank.best().imu);
  switch (hypothesis.imu) {
    case ImuModel::other_clock:
      return has_other_clock(hypothesis.filter);
    case ImuModel::wrong_headings:
      // A wrong gyroscope also contradicts the headings.
      return contradicts_headings(state, hypothesis.filter) &&
             (!best_is_distrustful || state.headings.offset_samples >= proven_offset_samples);
    case ImuModel::wrong_velocities:
      return state.twist && !state.twist->are_proven();
    default:
      return best_is_distrustful || !is_distrustful(hypothesis.imu);
  }
}

/// True if the yaw that a filter without headings tries is wrong.
bool has_wrong_yaw(const Hypothesis& hypothesis, const Hypothesis& best) {
  return hypothesis.imu == ImuModel::wrong_headings && is_distrustful(best.imu) &&
         hypothesis.score < best.score - max_start_score_deficit;
}

/// Lead that the score of a model needs over that of the best one.
double score_margin(const State& state, ImuModel model) {
  constexpr double noisier = 1.0;
  constexpr double quieter = 3.0;  // too much trust in an IMU costs more than too little
  constexpr double drift = 12.0;   // most biases change slowly
  constexpr double input = 8.0;    // most headings and velocities are right
  const ImuModel best = state.bank.best().imu;
  if (model == ImuModel::wrong_headings || model == ImuModel::wrong_velocities) return input;
  if (best == ImuModel::wrong_velocities && state.twist && state.twist->are_proven()) return -input;
  if (model == ImuModel::drifting_gyro) return drift;
  return model > best ? noisier : quieter;
}

/// True if it explains the fixes better than the best one.
bool is_better(const State& state, const Hypothesis& hypothesis) {
  const Hypothesis& best = state.bank.best();
  const bool trusts_more =
      is_distrustful(best.imu) && (!is_distrustful(hypothesis.imu) || best.imu == ImuModel::distrusts_imu);
  return trusts_more ? trusts_imu_again(hypothesis, state)
                     : hypothesis.score > best.score + score_margin(state, hypothesis.imu);
}

/// Continues with this distrustful model. One that jumped is trusted at once.
void adopt_distrustful_model(State& state, Hypothesis& chosen) {
  constexpr double memory_s = 60.0;
  constexpr int max_faults = 100;
  ImuFaultDetector& detector = state.imu_fault;
  const bool again =
      detector.detected_ns != 0 && seconds_between(detector.detected_ns, state.time_ns) < memory_s;
  detector.faults = again ? std::min(detector.faults + 1, max_faults) : 1;
  detector.detected_ns = state.time_ns;
  detector.faulty_until_ns = state.time_ns + fault_memory_ns;
  if (!is_distrustful(state.bank.best().imu)) {
    detector.trusted_gyro_bias_body_radps = state.filter().gyro_bias_body_radps;
    detector.trusted_accel_bias_body_mps2 = state.filter().accel_bias_body_mps2;
  }
  chosen.score = state.bank.best().score;
  const ImuModel model = chosen.imu;
  if (state.bank.find(Track::former) == nullptr) store_former_track(state, state.time_ns, state.time_ns);
  if (const Hypothesis* const other = find_other_track(state)) state.bank.remove(other);
  if (model == ImuModel::jumped) {
    state.bank.follow(state.bank.find(model)->filter);
  } else {
    if (const Hypothesis* const jumped = state.bank.find(ImuModel::jumped)) state.bank.remove(jumped);
    Hypothesis& best = *state.bank.find(model);
    state.bank.best_index = state.bank.index_of(best);
    for (Hypothesis& each : state.bank) {
      if (each.track == Track::followed && &each != &best) restart(each, best, state);
    }
  }
  forget_judgement(state);
}

}  // namespace

bool contradicts_headings(const State& state, const Filter& filter) {
  constexpr double sigmas = 5.0;
  constexpr int min_offset_samples = 3;
  const double noise_rad2 = std::max(state.noise.heading_rad2.variance, square(state.headings.std_rad));
  return motion_shows_yaw(filter) && state.headings.offset_samples >= min_offset_samples &&
         square(state.headings.offset_rad) > square(sigmas) * (filter.yaw_variance_rad2() + noise_rad2);
}

void restore_trusted_biases(const ImuFaultDetector& detector, Filter& filter) {
  if (detector.faults > 0) {
    filter.gyro_bias_body_radps = detector.trusted_gyro_bias_body_radps;
    filter.accel_bias_body_mps2 = detector.trusted_accel_bias_body_mps2;
  }
  filter.decorrelate(at_gyro_bias, Vector3d::Constant(square(start_gyro_bias_std_radps)));
  filter.decorrelate(at_accel_bias, Vector3d::Constant(square(start_accel_bias_std_mps2)));
}

void level_by_mean_force(const State& state, Filter& filter) {
  constexpr double max_error_mps2 = 1.0;
  const Vector3d& mean = state.imu.mean_force_body_mps2;
  if (!(std::abs(mean.norm() - gravity_world_mps2.norm()) < max_error_mps2)) return;
  const Vector3d tracked_world_m = filter.tracked_position_world_m();
  const double yaw_variance_rad2 = filter.yaw_variance_rad2();
  filter.q_body_to_world = geometry::level_with(mean, geometry::yaw_of(filter.q_body_to_world));
  filter.position_world_m = tracked_world_m + filter.q_body_to_world * filter.lever_arm_body_m;
  filter.decorrelate(at_attitude, Vector3d::Constant(square(radians(10.0))));
  filter.add_yaw_variance(yaw_variance_rad2);
}

void forget_judgement(State& state) {
  state.imu_fault.forget_innovations();
  state.fixes.misfits_in_row = 0;
  state.headings.accept();
  rest::restart(state.rest);
}

void choose_model(State& state) {
  constexpr double max_score_deficit = 8.0;  // the noise may change at any time
  constexpr int restart_after_misses = 6;
  HypothesisBank& bank = state.bank;
  for (Hypothesis& each : bank) {
    if (each.track != Track::followed || &each == &bank.best()) continue;
    const bool has_failed = each.missed_in_row >= restart_after_misses || has_wrong_yaw(each, bank.best());
    if (has_failed) restart(each, bank.best(), state);
    if (may_be_best(state, each) && is_better(state, each)) bank.best_index = bank.index_of(each);
  }
  const Hypothesis& best = bank.best();
  for (Hypothesis& each : bank) {
    if (each.track == Track::followed && each.imu > best.imu) {
      each.score = std::max(each.score, best.score - max_score_deficit);
    }
  }
  if (is_distrustful(best.imu)) state.imu_fault.faulty_until_ns = state.time_ns + fault_memory_ns;
}

void update_evidence(State& state, const JudgedFix& judged) {
  const Hypothesis& best = state.bank.best();
  const Innovation& of_best = judged.innovation_of(state.bank, best);
  ShiftedTrack& shifted = state.imu_fault.shifted;
  if (find_other_track(state) == nullptr)
    shifted.evidence = best.evidence;  // otherwise the shifted track would be the best from the start
  const double best_likelihood = std::max(log_likelihood(of_best), state.imu_fault.add_scatter(of_best));
  for (Hypothesis& each : state.bank) {
    add_evidence(each.evidence,
                 &each == &best ? best_likelihood : log_likelihood(judged.innovation_of(state.bank, each)));
  }
  add_evidence(shifted.evidence,
               shifted.add(judged.fix.time_ns, of_best.value_world_m, judged.covariance_m2));
}

/// Starts the distrustful models when fixes or headings fit badly, and ends them when none has for a while.
void update_distrustful_models(State& state, bool is_suspicious) {
  constexpr TimeNs suspicion_ns = 2'000'000'000;
  ImuFaultDetector& detector = state.imu_fault;
  if (is_suspicious) detector.suspicious_until_ns = state.time_ns + suspicion_ns;
  if (state.phase != Phase::tracking || is_distrustful(state.bank.best().imu)) return;
  const bool is_wanted = state.time_ns <= detector.suspicious_until_ns;
  for (const ImuModel model :
       {ImuModel::distrusts_gyro, ImuModel::distrusts_accel, ImuModel::distrusts_imu, ImuModel::jumped}) {
    const Hypothesis* const hypothesis = state.bank.find(model);
    // An IMU that seems to jump again so soon has another fault.
    const bool is_possible = model != ImuModel::jumped || state.time_ns >= detector.faulty_until_ns;
    if (is_wanted && is_possible && hypothesis == nullptr) {
      Hypothesis& added = state.bank.spawn(state.bank.best());
      set_imu_model(added, model);
    } else if (!is_wanted && hypothesis != nullptr) {
      state.bank.remove(hypothesis);
    }
  }
}

bool switch_to_distrustful_model(State& state) {
  // A start that is not proven is more likely to be wrong than the IMU, unless nothing else explains the
  // fixes.
  if (state.phase != Phase::tracking ||
      std::max(state.fixes.since_start, state.fixes.rejected_in_row / 2) < proven_fixes ||
      (std::max(state.fixes.rejected_in_row, state.headings.rejected_in_row) < min_rejected_in_row &&
       state.imu_fault.mean_innovation_chi2 <= chi2_explain_threshold))
    return false;
  Hypothesis* chosen = nullptr;
  for (Hypothesis& each : state.bank) {
    const bool is_candidate =
        each.track == Track::followed && is_distrustful(each.imu) && &each != &state.bank.best();
    if (is_candidate && (chosen == nullptr || each.evidence > chosen->evidence)) chosen = &each;
  }
  if (chosen == nullptr) return false;
  double max_evidence = state.imu_fault.shifted.evidence;
  if (const Hypothesis* const other = find_other_track(state))
    max_evidence = std::max(max_evidence, other->evidence);
  if (!(chosen->evidence >
        std::max(state.bank.best().evidence + min_evidence_margin, max_evidence + min_margin_over_tracks)))
    return false;
  const Hypothesis* const without_headings = state.bank.find(ImuModel::wrong_headings);
  if (without_headings != nullptr && without_headings->evidence > chosen->evidence) return false;
  adopt_distrustful_model(state, *chosen);
  return true;
}

namespace {

/// Log-likelihood of this innovation with another covariance.
double log_likelihood(const Vector3d& value_m, const Matrix3d& covariance_m2) {
  Innovation innovation;
  const Eigen::LLT<Matrix3d> factor(covariance_m2);
  innovation.squared_norm = factor.matrixL().solve(value_m).squaredNorm();
  innovation.log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return log_likelihood(innovation);
}

}  // namespace

void ImuFaultDetector::forget_innovations() {
  mean_innovation_world_m.setZero();
  mean_innovation_chi2 = 0.0;
}

void ImuFaultDetector::add_used(const Innovation& innovation) {
  constexpr double gain = 0.2;
  constexpr double variance = gain / (2.0 - gain);  // of the mean of white noise of variance 1
  mean_innovation_world_m += gain * (innovation.value_world_m - mean_innovation_world_m);
  mean_innovation_chi2 =
      Eigen::LLT<Matrix3d>(innovation.covariance_m2).matrixL().solve(mean_innovation_world_m).squaredNorm() /
      variance;
}

double ImuFaultDetector::add_scatter(const Innovation& innovation) {
  constexpr double smoothing_factor = 1.0 / 6.0;
  const bool is_known = scatter_m2.x() > 0.0;
  const Vector3d variances_m2 = scatter_m2.cwiseMax(innovation.covariance_m2.diagonal());
  scatter_m2 += (is_known ? smoothing_factor : 1.0) * (innovation.value_world_m.cwiseAbs2() - scatter_m2);
  return is_known ? log_likelihood(innovation.value_world_m, variances_m2.asDiagonal())
                  : wrong_fix_likelihood;
}

double ShiftedTrack::add(TimeNs time_ns, const Vector3d& offset_m, const Matrix3d& covariance_m2) {
  constexpr double chi2_restart_threshold = 16.0;
  constexpr double drift_std_mps = 0.3;
  constexpr double drift_change_mps_rts = 0.02;
  const double noise_m2 = covariance_m2.diagonal().maxCoeff();
  const double dt_s = seconds_between(seen_ns, time_ns);
  seen_ns = time_ns;
  const double predicted_drift_variance_m2ps2 = drift_variance_m2ps2 + square(drift_change_mps_rts) * dt_s;
  const double both = covariance_m2ps + dt_s * drift_variance_m2ps2;
  const double variance = variance_m2 + dt_s * (covariance_m2ps + both);
  const Vector3d predicted_m = offset_world_m + dt_s * drift_world_mps;
  const Matrix3d innovation_m2 = covariance_m2 + variance * Matrix3d::Identity();
  const double distance =
      Eigen::LLT<Matrix3d>(innovation_m2).matrixL().solve(offset_m - predicted_m).squaredNorm();
  if (variance_m2 == 0.0 || distance > chi2_restart_threshold) {
    offset_world_m = offset_m;
    drift_world_mps.setZero();
    variance_m2 = noise_m2;
    covariance_m2ps = 0.0;
    drift_variance_m2ps2 = square(drift_std_mps);
    return wrong_fix_likelihood;
  }
  const double gain = variance / (variance + noise_m2);
  const double rate_gain = both / (variance + noise_m2);
  offset_world_m = predicted_m + gain * (offset_m - predicted_m);
  drift_world_mps += rate_gain * (offset_m - predicted_m);
  variance_m2 = (1.0 - gain) * variance;
  covariance_m2ps = (1.0 - gain) * both;
  drift_variance_m2ps2 = predicted_drift_variance_m2ps2 - rate_gain * both;
  return log_likelihood(offset_m - predicted_m, innovation_m2);
}

}  // namespace sonopose::estimation::kalman
