#include <sonopose/estimation/documented/trust.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::trust {
namespace {

/// The fix minus its prediction, by the previous fix or by the fused position.
Vector3d innovation_of(const TrustState& state, const Kinematics& body, const TimedFix& fix,
                       bool against_imu) {
  const Vector3d to_fused_m = fix.shifted_position_world_m - body.position_world_m;
  if (against_imu || !state.has_last) return to_fused_m;
  const auto moved_world_m = body.moved(state.last_measured_ns, fix.measured_ns);
  if (!moved_world_m) return to_fused_m;
  return fix.measured_position_world_m - state.last_position_world_m - *moved_world_m;
}

/// Items 16–19: N = clamp(n_base · jump / reference, n_min, n_max).
int rebuild_count(const TrustSettings& settings, double jump_m) {
  const double scaled = std::round(settings.n_base * jump_m / settings.reference_innovation_m);
  const int n_max = std::max(settings.n_min, settings.n_max);
  return static_cast<int>(std::clamp<double>(scaled, settings.n_min, n_max));
}

void lose(const TrustSettings& settings, TrustState& state, double jump_m) {
  if (state.trust >= 1.0) {
    state.since_loss = 0;
    state.outliers_in_row = 0;
  }
  state.trust = 0.0;
  state.rebuilt = 0;
  state.rebuild_n = rebuild_count(settings, jump_m);
}

void regain(TrustState& state) {
  state.trust = 1.0;
  state.rebuilt = 0;
  state.since_loss = 0;
  state.outliers_in_row = 0;
  state.forced = false;
}

/// Items 15–20 for one fix, once it is known whether it is an outlier.
void update(const TrustSettings& settings, TrustState& state, double innovation_m, bool outlier) {
  const bool was_at_zero = state.trust <= 0.0;
  if (outlier) {
    if (!was_at_zero) lose(settings, state, innovation_m);
    ++state.outliers_in_row;
  } else if (state.trust < 1.0) {
    state.outliers_in_row = 0;
    ++state.rebuilt;
    state.trust = std::min(1.0, static_cast<double>(state.rebuilt) / state.rebuild_n);
  }
  if (state.trust >= 1.0) return regain(state);

  ++state.since_loss;
  if (state.since_loss > settings.n_max) return regain(state);  // item 19
  if (state.outliers_in_row > settings.stuck_n) state.forced = true;
}

}  // namespace

double weight_of(double innovation_m, double sigma_m) {
  const double ratio = innovation_m / sigma_m;
  return 1.0 / (1.0 + ratio * ratio);
}

bool is_far(const TrustSettings& settings, double distance_m) {
  return distance_m > settings.sigma_m;
}

void restart(TrustState& state, const TimedFix& fix) {
  state = TrustState{};
  state.has_last = true;
  state.last_measured_ns = fix.measured_ns;
  state.last_position_world_m = fix.measured_position_world_m;
}

FixAssessment assess(const TrustSettings& settings, TrustState& state, const Kinematics& body,
                     const TimedFix& fix) {
  const bool against_imu = settings.enabled && state.trust < 1.0;
  const bool was_forced = state.forced;
  FixAssessment assessment;
  assessment.innovation_world_m = innovation_of(state, body, fix, against_imu);
  assessment.innovation_m = assessment.innovation_world_m.norm();
  const double limit_m = settings.outlier_sigmas * settings.sigma_m;
  assessment.outlier = assessment.innovation_m > limit_m;
  const double ratio = assessment.innovation_m / limit_m;
  assessment.test_ratio = ratio * ratio;

  if (!settings.enabled) {
    regain(state);
  } else if (state.forced) {
    if (assessment.innovation_m < settings.sigma_m) regain(state);
  } else {
    update(settings, state, assessment.innovation_m, assessment.outlier);
  }
  assessment.track_accepted =
      (state.forced && !was_forced) || (assessment.outlier && state.trust >= 1.0 && against_imu);
  assessment.new_track = assessment.track_accepted || (!settings.enabled && assessment.outlier);
  assessment.trusted = state.trust >= 1.0;
  assessment.forced = state.forced;
  assessment.weight =
      std::max(settings.min_weight, weight_of(assessment.innovation_m, settings.sigma_m) * state.trust);
  if (state.forced) {
    assessment.jump_floor = settings.stuck_jump_scale;
    assessment.weight_floor = settings.stuck_weight_floor;
  }
  state.has_last = true;
  state.last_measured_ns = fix.measured_ns;
  state.last_position_world_m = fix.measured_position_world_m;
  return assessment;
}

}  // namespace sonopose::estimation::documented::trust
