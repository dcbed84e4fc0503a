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
  const auto moved_world_m = body.displacement_between(state.last_measured_ns, fix.measured_ns);
  if (!moved_world_m) return to_fused_m;
  return fix.measured_position_world_m - state.last_position_world_m - *moved_world_m;
}

void begin_rivals(TrustState& state, const Kinematics& body, const TimedFix& fix) {
  state.rivals = 1;
  state.strays = 0;
  state.rival_measured_ns = fix.measured_ns;
  state.rival_position_world_m = fix.measured_position_world_m;
  state.rival_excess_world_mps.setZero();
  state.rival_offset_world_m = fix.shifted_position_world_m - body.position_world_m;
}

/// Adds an outlier that agrees with the latest one. One deviation of the velocity is mostly noise.
void add_rival(TrustState& state, const TimedFix& fix, const Vector3d& excess_world_mps) {
  constexpr double share_of_one = 0.5;
  ++state.rivals;
  state.strays = 0;
  state.rival_excess_world_mps +=
      (state.rivals == 2 ? 1.0 : share_of_one) * (excess_world_mps - state.rival_excess_world_mps);
  state.rival_measured_ns = fix.measured_ns;
  state.rival_position_world_m = fix.measured_position_world_m;
}

/// Counts consecutive outliers that agree with each other along the IMU's path, up to a constant velocity,
/// which an IMU gets wrong. The third shows whether the first two were on a track. A single stray does not
/// end it.
void follow_rivals(TrustState& state, const Kinematics& body, const TimedFix& fix, double limit_m,
                   FixAssessment& assessment) {
  if (!assessment.outlier) {
    state.rivals = 0;
    return;
  }
  const auto moved_world_m = body.displacement_between(state.rival_measured_ns, fix.measured_ns);
  if (state.rivals == 0 || !moved_world_m) {
    begin_rivals(state, body, fix);
    assessment.rivals = 1;
    return;
  }
  const double interval_s = seconds_between(state.rival_measured_ns, fix.measured_ns);
  const Vector3d step_world_m = fix.measured_position_world_m - state.rival_position_world_m;
  const Vector3d excess_world_m = step_world_m - *moved_world_m;
  const bool same_path = excess_world_m.norm() <= limit_m;
  double residual_m = (excess_world_m - interval_s * state.rival_excess_world_mps).norm();
  const bool same_velocity = residual_m <= limit_m;
  if (!same_velocity && state.rivals > 1) {
    if (!same_path && state.rivals > 2 && state.strays == 0) {
      ++state.strays;
      return;
    }
    // The latest rival and this outlier may begin a track.
    begin_rivals(state, body, fix);
    if (!same_path) {
      assessment.rivals = 1;
      return;
    }
    residual_m = excess_world_m.norm();
  }
  add_rival(state, fix, excess_world_m / interval_s);
  assessment.rivals = state.rivals;
  assessment.rival_residual_m = residual_m;
  if (same_path || state.rivals > 2) assessment.rival_step_world_m = step_world_m;
}

/// True if the pose moves away from a track of outliers that agree with each other. A wrong track jumps away
/// and then keeps its distance, because the IMU measures its motion. A growing distance means a wrong
/// velocity.
bool moves_away(const TrustState& state, const Kinematics& body, const TimedFix& fix, double limit_m,
                const FixAssessment& assessment) {
  constexpr int min_rivals = 5;
  if (assessment.rivals < min_rivals) return false;
  const Vector3d offset_world_m = fix.shifted_position_world_m - body.position_world_m;
  return (offset_world_m - state.rival_offset_world_m).norm() > limit_m;
}

/// Factor on item 13 while a fix's place is less certain than usual: after a pause of the fixes, and while
/// the velocity is an average of a few. 1 on an ordinary track.
double tolerance_for(const TrustSettings& settings, const TrustState& state, const TimedFix& fix,
                     std::optional<int> velocities, double yaw_error_mps) {
  constexpr double ordinary_pause_s = 0.25;
  constexpr double growth_hz = 4.0;
  constexpr double first_velocity_tolerance = 4.0;
  double tolerance = 1.0;
  if (velocities) tolerance += first_velocity_tolerance / (1 + *velocities);
  if (!state.has_last) return tolerance;
  const double pause_s = seconds_between(state.last_measured_ns, fix.measured_ns);
  return tolerance + growth_hz * std::max(0.0, pause_s - ordinary_pause_s) +
         yaw_error_mps * pause_s / settings.sigma_m;
}

/// Items 16–19: N = clamp(n_base · jump / reference, n_min, n_max).
int rebuild_count(const TrustSettings& settings, double jump_m) {
  const double scaled = std::round(settings.n_base * jump_m / settings.reference_innovation_m);
  const int n_max = std::max(settings.n_min, settings.n_max);
  return static_cast<int>(std::clamp<double>(scaled, settings.n_min, n_max));
}

void lose_trust(const TrustSettings& settings, TrustState& state, double jump_m) {
  if (state.trust >= 1.0) {
    state.since_loss = 0;
    state.outliers_in_row = 0;
  }
  state.trust = 0.0;
  state.rebuilt = 0;
  state.rebuild_n = rebuild_count(settings, jump_m);
}

void restore_trust(TrustState& state) {
  state.trust = 1.0;
  state.rebuilt = 0;
  state.since_loss = 0;
  state.outliers_in_row = 0;
  state.forced = false;
}

/// Applies items 15–20 to one fix that is known to be an outlier or not.
void update(const TrustSettings& settings, TrustState& state, double innovation_m, bool outlier) {
  const bool was_at_zero = state.trust <= 0.0;
  if (outlier) {
    if (!was_at_zero) lose_trust(settings, state, innovation_m);
    ++state.outliers_in_row;
  } else if (state.trust < 1.0) {
    state.outliers_in_row = 0;
    ++state.rebuilt;
    state.trust = std::min(1.0, static_cast<double>(state.rebuilt) / state.rebuild_n);
  }
  if (state.trust >= 1.0) return restore_trust(state);

  ++state.since_loss;
  if (state.since_loss > settings.n_max) return restore_trust(state);  // item 19
  if (state.outliers_in_row > settings.stuck_n) state.forced = true;
}

}  // namespace

double weight_of(double innovation_m, double sigma_m) {
  const double ratio = innovation_m / sigma_m;
  return 1.0 / (1.0 + ratio * ratio);
}

Vector3d share_of(const TrustSettings& settings, const Vector3d& noise_world_m) {
  constexpr double ordinary_noise = 0.35;  // in units of item 13
  return (ordinary_noise * settings.sigma_m * noise_world_m.cwiseInverse()).cwiseMin(1.0);
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
                     const TimedFix& fix, std::optional<int> velocities, double yaw_error_mps) {
  const bool against_imu = settings.enabled && state.trust < 1.0;
  const bool was_forced = state.forced;
  FixAssessment assessment;
  assessment.innovation_world_m = innovation_of(state, body, fix, against_imu);
  assessment.innovation_m = assessment.innovation_world_m.norm();
  assessment.sigma_m = tolerance_for(settings, state, fix, velocities, yaw_error_mps) * settings.sigma_m;
  const double limit_m = settings.outlier_sigmas * assessment.sigma_m;
  assessment.outlier = assessment.innovation_m > limit_m;
  const double ratio = assessment.innovation_m / limit_m;
  assessment.test_ratio = ratio * ratio;
  follow_rivals(state, body, fix, limit_m, assessment);

  if (!settings.enabled) {
    restore_trust(state);
  } else if (state.forced) {
    if (assessment.innovation_m < settings.sigma_m) restore_trust(state);
  } else {
    update(settings, state, assessment.innovation_m, assessment.outlier);
    if (state.trust < 1.0 && moves_away(state, body, fix, limit_m, assessment)) state.forced = true;
  }
  assessment.track_accepted =
      (state.forced && !was_forced) || (assessment.outlier && state.trust >= 1.0 && against_imu);
  assessment.new_track = assessment.track_accepted || (!settings.enabled && assessment.outlier);
  assessment.trusted = state.trust >= 1.0;
  assessment.forced = state.forced;
  assessment.weight =
      std::max(settings.min_weight, weight_of(assessment.innovation_m, assessment.sigma_m) * state.trust);
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
