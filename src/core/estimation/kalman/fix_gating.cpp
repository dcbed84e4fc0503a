// Judgement of a fix.

#include "estimation/kalman/state_internal.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

/// Above it, a fix does not correct a hypothesis.
constexpr double chi2_miss_threshold = 2.0 * chi2_reject_threshold;

/// Begins or ends the estimation of the delay, as the settings demand. Models that do not rely on the clock
/// or the IMU keep their estimate.
void estimate_delay(State& state, const settings::DelaySettings& settings) {
  constexpr double initial_std_s = 0.02;
  for (Hypothesis& each : state.bank) {
    const bool keeps = each.imu == ImuModel::other_clock || is_distrustful(each.imu);
    if (keeps || each.filter.estimates_delay() == settings.estimate) continue;
    each.filter.estimate_delay(settings.estimate ? square(initial_std_s) : 0.0);
  }
}

/// Start that explains a fix best.
int nearest_start(const HypothesisBank& bank, const Innovations& innovations) {
  int nearest = bank.best_index;
  const auto distance = [&](int i) { return innovations[static_cast<std::size_t>(i)].squared_norm; };
  for (int i = 0; i < bank.size(); ++i) {
    if (bank[i].track == Track::followed && distance(i) < distance(nearest)) nearest = i;
  }
  return nearest;
}

/// Corrects the hypotheses on the followed track.
void correct_followed(State& state, const JudgedFix& judged, const Matrix3d& more_covariance_m2) {
  constexpr double forgetting = 1.0 / 60.0;
  for (Hypothesis& each : state.bank) {
    if (each.track != Track::followed) continue;
    const Innovation& innovation = judged.innovation_of(state.bank, each);
    if (state.phase == Phase::tracking) each.score *= 1.0 - forgetting;
    each.score += log_likelihood(innovation);
    const bool missed = innovation.squared_norm > chi2_miss_threshold;
    each.missed_in_row = missed ? each.missed_in_row + 1 : 0;
    each.explained_in_row =
        innovation.squared_norm <= chi2_explain_threshold ? std::min(each.explained_in_row + 1, 10000) : 0;
    if (!missed) each.filter.correct_fix(innovation, more_covariance_m2);
  }
  if (state.phase == Phase::searching_yaw) {
    if (!restart_search(state)) prune_starts(state);
    return;
  }
  choose_model(state);
}

/// Corrects the distrustful models by a fix that the best hypothesis rejects.
void correct_distrustful(State& state, const JudgedFix& judged) {
  for (Hypothesis& each : state.bank) {
    if (each.track != Track::followed || !is_distrustful(each.imu) || &each == &state.bank.best()) continue;
    const Innovation& innovation = judged.innovation_of(state.bank, each);
    if (!(innovation.squared_norm <= chi2_reject_threshold)) continue;
    correct_scaled(each.filter, innovation, judged.covariance_m2);
  }
}

/// Learns the noise of fixes from the residual of one that was used.
void learn_noise(State& state, const JudgedFix& judged) {
  // An error of the motion would count as noise.
  if (judged.fix.has_covariance || is_distrustful(state.bank.best().imu)) return;
  const Innovation& before = judged.innovation_of(state.bank, state.bank.best());
  state.noise.correlation.add(before.value_world_m, before.covariance_m2);
  const Innovation after = state.filter().fix_innovation(judged.fix.position_world_m, judged.covariance_m2,
                                                         judged.ahead_s, judged.fix.point_body_m);
  state.noise.add_fix(
      judged.fix.quality_percent, std::sqrt(state.noise.correlation.white_share()) * after.value_world_m,
      (after.covariance_m2 - judged.covariance_m2).diagonal(), stands_still(state, min_rest_fixes));
}

/// Looks for slow errors in the innovations of `quiet`, or of the best model if it differs in more than the
/// noise of the IMU.
void observe_slow_error(State& state, const JudgedFix& judged) {
  constexpr double moving_mps = 0.1;
  const Hypothesis& best = state.bank.best();
  const Hypothesis* const stiff = best.imu <= ImuModel::rough ? state.bank.find(ImuModel::quiet) : &best;
  const Innovation& innovation = judged.innovation_of(state.bank, *stiff);
  if (innovation.squared_norm > chi2_miss_threshold) return;
  state.slow_error.add(judged.fix.time_ns, innovation.value_world_m, innovation.covariance_m2,
                       judged.covariance_m2, best.filter.velocity_world_mps.norm() > moving_mps);
}

/// Raises the noise after several consecutive fixes that fit badly and form no track. Otherwise it would stay
/// small: most fixes are then rejected, and after a rejection a used one says little about the noise.
void learn_from_scatter(State& state, const JudgedFix& judged, const Innovation& innovation) {
  constexpr int min_scattered_fixes = 6;
  constexpr double max_m = 2.0;  // four times the largest noise that is learned
  const FixGate& gate = state.fixes;
  const Hypothesis* const other = find_other_track(state);
  const bool is_track = other != nullptr && other->explained >= min_track_fixes;
  if (state.phase != Phase::tracking || judged.fix.has_covariance || gate.since_start < proven_fixes ||
      gate.misfits_in_row < min_scattered_fixes || is_track || innovation.value_world_m.norm() > max_m)
    return;
  state.noise.add_rejected_fix(judged.fix.quality_percent, innovation.value_world_m);
}

/// Ends the comparison of the hypotheses, because the fixes returned to the best one.
void end_comparison(State& state) {
  const double evidence = state.bank.best().evidence;
  for (Hypothesis& each : state.bank) each.evidence = std::min(each.evidence, evidence);
  state.imu_fault.shifted.evidence = std::min(state.imu_fault.shifted.evidence, evidence);
  state.imu_fault.is_undecided = false;
}

/// True if this fix belongs to the track to which the fixes have jumped: that track explains it better than
/// the best hypothesis, which accepts it only because it has become uncertain meanwhile. If the fixes have
/// parted from the best hypothesis slowly, that one was probably wrong.
bool is_of_other_track(State& state, const JudgedFix& judged, const Innovation& innovation) {
  constexpr double min_jump_share = 0.5;
  const Hypothesis* const other = find_other_track(state);
  return other != nullptr && state.phase == Phase::tracking &&
         state.fixes.rejected_in_row >= min_rejected_in_row && other->explained >= min_track_fixes &&
         other->missed_in_row == 0 &&
         state.fixes.first_rejected_m > min_jump_share * innovation.value_world_m.norm() &&
         log_likelihood(judged.innovation_of(state.bank, *other)) > log_likelihood(innovation);
}

void compute_innovations(const HypothesisBank& bank, JudgedFix& judged) {
  for (int i = 0; i < bank.size(); ++i) {
    judged.innovations[static_cast<std::size_t>(i)] = bank[i].filter.fix_innovation(
        judged.fix.position_world_m, judged.covariance_m2, judged.ahead_s, judged.fix.point_body_m);
  }
}

/// True if the height of a fix alone contradicts the best hypothesis, and jumped: beacons at about one height
/// mirror or shift heights, but no body jumps. The heights then keep their sum or difference with those
/// predicted; otherwise the prediction is wrong, or the heights scatter.
bool only_height_jumped(HeightGate& gate, const FixMeasurement& fix, const Innovation& innovation,
                        double since_used_s) {
  constexpr double height_chi2_threshold = 25.0;     // 1 degree of freedom: five standard deviations
  constexpr double horizontal_chi2_threshold = 9.2;  // 2 degrees of freedom: 1 % is above
  constexpr double max_change_share = 0.25;
  const double height_m = innovation.value_world_m.z();
  const double predicted_m = fix.position_world_m.z() - height_m;
  const double shift_m = height_m - gate.first_m;
  const double mirror_m = shift_m + 2.0 * (predicted_m - gate.predicted_m);
  const bool continues = gate.jumped_ns != 0 && std::min(std::abs(shift_m), std::abs(mirror_m)) <
                                                    max_change_share * std::abs(gate.first_m);
  // The estimate becomes uncertain meanwhile, and would accept any height.
  if (!continues && !(square(height_m) > height_chi2_threshold * innovation.covariance_m2(2, 2))) {
    gate = {};
    return false;
  }
  // What an accelerometer that failed before the last fix may cause is no jump.
  const double by_fault_m = 2.0 * standard_gravity_mps2 * square(since_used_s);
  const bool begins = gate.jumped_ns == 0 && std::abs(height_m) > by_fault_m;
  if (begins)
    gate = {.jumped_ns = fix.time_ns, .left_out_ns = 0, .first_m = height_m, .predicted_m = predicted_m};
  const Vector3d level_m(innovation.value_world_m.x(), innovation.value_world_m.y(), 0.0);
  Matrix3d level_m2 = innovation.covariance_m2;
  level_m2.row(2).head<2>().setZero();
  level_m2.col(2).head<2>().setZero();
  const double chi2 = Eigen::LLT<Matrix3d>(level_m2).matrixL().solve(level_m).squaredNorm();
  return (begins || continues) && chi2 <= horizontal_chi2_threshold &&
         seconds_between(gate.jumped_ns, fix.time_ns) < HeightGate::believed_after_s;
}

/// Leaves out a height that has jumped. While a former track lives, either track may be right.
void leave_out_height(State& state, JudgedFix& judged, FixMeasurement& fix) {
  constexpr double ignored_m2 = 100.0;
  const bool knows_height = state.phase == Phase::tracking && state.fixes.since_start >= proven_fixes &&
                            !is_distrustful(state.bank.best().imu) &&
                            state.bank.find(Track::former) == nullptr;
  if (!knows_height) {
    state.fixes.height = {};
    return;
  }
  const Innovation& innovation = judged.innovation_of(state.bank, state.bank.best());
  const double since_used_s = seconds_between(state.fixes.used_ns, fix.time_ns);
  if (!only_height_jumped(state.fixes.height, fix, innovation, since_used_s)) return;
  state.fixes.height.left_out_ns = fix.time_ns;
  fix.position_world_m.z() -= innovation.value_world_m.z();
  fix.has_covariance = true;  // its residual says nothing about the noise
  judged.covariance_m2(2, 2) += ignored_m2;
  compute_innovations(state.bank, judged);
}

FixOutcome judge(State& state, const settings::Settings& settings, const FixMeasurement& measured) {
  FixMeasurement fix = measured;
  JudgedFix judged{.settings = settings,
                   .fix = fix,
                   .covariance_m2 = covariance_of(state, fix),
                   .ahead_s = seconds_between(state.time_ns, fix.time_ns),
                   .innovations = {}};
  compute_innovations(state.bank, judged);
  leave_out_height(state, judged, fix);
  const int judge = state.phase == Phase::searching_yaw ? nearest_start(state.bank, judged.innovations)
                                                        : state.bank.best_index;
  const Innovation& innovation = judged.innovations[static_cast<std::size_t>(judge)];
  FixOutcome outcome{.innovation = innovation,
                     .has_innovation = true,
                     .covariance_world_m2 = judged.covariance_m2,
                     .test_ratio = innovation.squared_norm / chi2_reject_threshold};
  const bool is_used =
      innovation.squared_norm <= chi2_reject_threshold && !is_of_other_track(state, judged, innovation);
  constexpr double trust_memory = 8.0;
  state.fixes.trust += ((is_used ? 1.0 : 0.0) - state.fixes.trust) / trust_memory;
  const bool fits_badly = innovation.squared_norm > chi2_huber_threshold;
  state.fixes.misfits_in_row = fits_badly ? state.fixes.misfits_in_row + 1 : 0;
  update_evidence(state, judged);
  if (is_used) {
    const double scale = scale_of(innovation);
    // After rejected fixes the estimate is uncertain too.
    const Matrix3d more_covariance_m2 =
        (scale - 1.0) * (state.fixes.rejected_in_row > 0 ? innovation.covariance_m2 : judged.covariance_m2);
    outcome.weight = 1.0 / scale;
    outcome.covariance_world_m2 += more_covariance_m2;
    outcome.flags = fix_used;
    if (state.imu_fault.is_undecided && !fits_badly) end_comparison(state);
    const bool is_tracking = state.phase == Phase::tracking;
    if (is_tracking) observe_slow_error(state, judged);
    correct_followed(state, judged, more_covariance_m2);
    if (is_tracking) learn_noise(state, judged);
    note_used(state, fix);
    if (is_tracking) {
      state.imu_fault.add_used(innovation);
      if (fits_badly) switch_to_distrustful_model(state);
    }
  } else {
    if (++state.fixes.rejected_in_row == 1) state.fixes.first_rejected_m = innovation.value_world_m.norm();
    if (state.fixes.rejected_in_row >= min_rejected_in_row) state.imu_fault.is_undecided = true;
    correct_distrustful(state, judged);
    if (switch_to_distrustful_model(state)) {
      note_used(state, fix);
      outcome.flags = fix_used;
      outcome.weight = 1.0;
    } else {
      judge_rejected(state, judged, outcome);
    }
  }
  learn_from_scatter(state, judged, innovation);
  update_distrustful_models(state, std::max(outcome.innovation.squared_norm,
                                            state.imu_fault.mean_innovation_chi2) > chi2_explain_threshold);
  return outcome;
}

/// Square of the way since coordinates began to repeat, beyond what rounding and noise explain.
Matrix3d way_since_repetition_m2(const FrozenTrackDetector& track) {
  constexpr double explained_m = 0.04;
  const double way_m = track.moved_world_m.norm();
  if (track.repeats == 0 || way_m <= explained_m) return Matrix3d::Zero();
  const Vector3d beyond_m = (1.0 - explained_m / way_m) * track.moved_world_m;
  return beyond_m * beyond_m.transpose();
}

}  // namespace

/// Covariance of the source, or the learned one. Coordinates that repeat may be those of an earlier place.
Matrix3d covariance_of(const State& state, const FixMeasurement& fix) {
  const Matrix3d added_m2 = fix.covariance_world_m2 + way_since_repetition_m2(state.frozen_track);
  if (fix.has_covariance) return added_m2;
  Matrix3d covariance_m2 = state.noise.fix_covariance_m2(fix.quality_percent) + added_m2;
  // Residuals say nothing about the noise while the filter follows the fixes alone.
  if (state.phase == Phase::tracking && is_distrustful(state.bank.best().imu)) {
    covariance_m2.diagonal() = covariance_m2.diagonal().cwiseMax(state.noise.scatter.noise_m2());
  }
  return covariance_m2;
}

void note_used(State& state, const FixMeasurement& fix) {
  FixGate& gate = state.fixes;
  gate.since_start = std::min(gate.since_start + 1, proven_fixes);
  gate.rejected_in_row = 0;
  gate.used_ns = fix.time_ns;
  gate.quality_percent = fix.quality_percent;
  state.last_zero_velocity_ns = std::max(state.last_zero_velocity_ns, fix.time_ns);
  rest::add_fix(state.rest, fix.time_ns, tracked_at(fix, state.filter()));
  if (Hypothesis* const former = state.bank.find(Track::former)) former->explained_in_row = 0;
  // The other track lives on rejected fixes alone.
  constexpr TimeNs idle_ns = 1'500'000'000;
  const Hypothesis* const other = find_other_track(state);
  if (other != nullptr && fix.time_ns - other->explained_ns > idle_ns) end_other_track(state, fix.time_ns);
}

FixOutcome State::on_fix(const settings::Settings& settings, const FixMeasurement& fix) {
  FixOutcome outcome;
  if (imu.time_ns == 0) return outcome;
  propagate();
  predict_if_silent(*this, settings, fix.time_ns);
  const bool has_started = phase != Phase::waiting;
  // Several tags show neither a default nor a frozen position, nor the scatter of one.
  const bool is_same_tag = !fix.restarts && fix.point_body_m == fixes.point_body_m;
  if (!fix.restarts) fixes.point_body_m = fix.point_body_m;
  if (is_same_tag && default_position.add(fix.time_ns, fix.position_world_m)) {
    // The estimate may have started at the default position.
    constexpr double near_m = 0.5;
    const bool is_there =
        has_started && (filter().tracked_position_world_m() - tracked_at(fix, filter())).norm() < near_m;
    if (fixes.since_start < proven_fixes && is_there) restart_pending = true;
    outcome.flags = fix_outlier;
    return outcome;
  }
  if (!is_same_tag) frozen_track = {};
  if (is_same_tag) noise.scatter.add(fix.time_ns, fix.position_world_m);
  if (is_same_tag &&
      frozen_track.add(settings.frozen, imu.time_ns, fix.position_world_m,
                       has_started ? filter().tracked_velocity_world_mps() : Vector3d::Zero())) {
    bank.remove(Track::other);
    bank.remove(Track::turned);
    outcome.flags = fix_frozen;
    return outcome;
  }
  if (!has_started || restart_pending || fix.restarts) {
    const Vector3d before_m = has_started ? filter().tracked_position_world_m() : Vector3d::Zero();
    outcome = {.covariance_world_m2 = covariance_of(*this, fix),
               .weight = 1.0,
               .flags = fix_used | (has_started ? fix_stale_recovered : fix_first),
               .starts = true};
    start_at(*this, fix, settings);
    recover_if_not_finite(*this);
    if (phase == Phase::waiting) return {.flags = fix_outlier};  // no direction of gravity in absurd samples
    if (has_started && before_m.allFinite()) {
      outcome.jump_world_m = filter().tracked_position_world_m() - before_m;
    }
    return outcome;
  }
  estimate_delay(*this, settings.delay);
  const Vector3d position_before = filter().tracked_position_world_m();
  const Vector3d velocity_before = filter().tracked_velocity_world_mps();
  const double yaw_before = geometry::yaw_of(filter().q_body_to_world);
  const bool is_stale = seconds_between(fixes.used_ns, fix.time_ns) > settings.outage.stale_after_s;
  outcome = judge(*this, settings, fix);
  recover_if_not_finite(*this);
  if (phase == Phase::waiting) return outcome;
  outcome.jump_world_m = filter().tracked_position_world_m() - position_before;
  outcome.velocity_change_world_mps = filter().tracked_velocity_world_mps() - velocity_before;
  outcome.yaw_change_rad = geometry::wrap_angle(geometry::yaw_of(filter().q_body_to_world) - yaw_before);
  if (is_stale && (outcome.flags & fix_used) != 0) outcome.flags |= fix_stale_recovered;
  return outcome;
}

}  // namespace sonopose::estimation::kalman
