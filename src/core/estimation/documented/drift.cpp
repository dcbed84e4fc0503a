#include <sonopose/estimation/documented/drift.hpp>
#include <sonopose/estimation/documented/lag.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::drift {

double jump_share(const DriftSettings& settings, const FixAssessment& assessment) {
  return std::max(settings.jump_alpha * assessment.weight, assessment.jump_floor);
}

Vector3d correct(const DriftSettings& settings, DriftState& state, Kinematics& body, const TimedFix& fix,
                 const FixAssessment& assessment) {
  const Vector3d discrepancy_world_m = fix.shifted_position_world_m - body.position_world_m;
  Vector3d jump_world_m = jump_share(settings, assessment) * discrepancy_world_m;
  body.position_world_m += jump_world_m;
  state.offset_world_m = discrepancy_world_m - jump_world_m;
  state.weight = std::max(assessment.weight, assessment.weight_floor);
  return jump_world_m;
}

void apply_decay(const DriftSettings& settings, DriftState& state, Kinematics& body, double dt_s) {
  // Substeps keep the decay stable at any IMU rate; one is enough at usual rates.
  const double steps = std::max(1.0, std::ceil(4.0 * settings.decay_rate_hz * dt_s));
  const double step_s = dt_s / steps;
  const double share = lag_share(settings.velocity_smooth_rate_hz * step_s);  // exact u' = rate (u* - u)
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    const Vector3d wanted_world_mps = settings.decay_rate_hz * state.weight * state.offset_world_m;
    state.velocity_world_mps += share * (wanted_world_mps - state.velocity_world_mps);
    const Vector3d applied_world_m = state.velocity_world_mps * step_s;
    body.position_world_m += applied_world_m;
    state.offset_world_m -= applied_world_m;
  }
}

}  // namespace sonopose::estimation::documented::drift
