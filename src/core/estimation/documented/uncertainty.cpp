#include <sonopose/estimation/documented/uncertainty.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::uncertainty {
namespace {

/// Standard deviation of (1 − share)·estimate + share·measurement.
double blended(double estimate_std, double measurement_std, double share) {
  const double kept_std = (1.0 - share) * estimate_std;
  const double added_std = share * measurement_std;
  return std::sqrt(kept_std * kept_std + added_std * added_std);
}

}  // namespace

void grow(const UncertaintySettings& settings, UncertaintyState& state, double dt_s) {
  state.velocity_std_mps =
      std::min(state.velocity_std_mps + settings.accel_std_mps2 * dt_s, UncertaintyState::unknown_mps);
  state.position_std_m =
      std::min(state.position_std_m + state.velocity_std_mps * dt_s, UncertaintyState::unknown_m);
  const double drift_radps = settings.yaw_drift_std_degps * geometry::radians_per_degree;
  state.yaw_std_rad = std::min(state.yaw_std_rad + drift_radps * dt_s, UncertaintyState::unknown_yaw_rad);
}

void correct(const UncertaintySettings& settings, UncertaintyState& state, double weight,
             double position_share, double velocity_share, double interval_s) {
  if (weight <= 0.0) return;
  // A fix of half the weight has twice the variance.
  const double fix_std_m = settings.fix_std_m / std::sqrt(weight);
  state.position_std_m = blended(state.position_std_m, fix_std_m, position_share);
  if (interval_s <= 0.0) return;
  const double fix_velocity_std_mps = std::numbers::sqrt2 * fix_std_m / interval_s;
  state.velocity_std_mps = blended(state.velocity_std_mps, fix_velocity_std_mps, velocity_share);
}

void correct_yaw(const UncertaintySettings& settings, UncertaintyState& state, double share) {
  const double heading_std_rad = settings.heading_std_deg * geometry::radians_per_degree;
  if (share <= 0.0 || state.yaw_std_rad <= heading_std_rad) return;
  state.yaw_std_rad = std::max(heading_std_rad, blended(state.yaw_std_rad, heading_std_rad, share));
}

void align_yaw(UncertaintyState& state, double share, double measurement_std_rad) {
  if (share <= 0.0) return;
  state.yaw_std_rad = std::min(state.yaw_std_rad, blended(state.yaw_std_rad, measurement_std_rad, share));
}

void reset_position(const UncertaintySettings& settings, UncertaintyState& state) {
  state.position_std_m = settings.fix_std_m;
}

Covariance<6> pose_covariance(const UncertaintyState& state, const Vector3d& share) {
  const Vector3d position_m2 = state.position_std_m * state.position_std_m * share.cwiseInverse();
  const double yaw_rad2 = state.yaw_std_rad * state.yaw_std_rad;
  constexpr double unknown = Covariance<6>::unknown;
  Covariance<6>::Vector variances;
  variances << position_m2, unknown, unknown, yaw_rad2;
  return Covariance<6>::from_diagonal(variances);
}

Covariance<3> velocity_covariance(const UncertaintyState& state, const Vector3d& share) {
  return Covariance<3>::from_diagonal(state.velocity_std_mps * state.velocity_std_mps * share.cwiseInverse());
}

}  // namespace sonopose::estimation::documented::uncertainty
