#include <sonopose/estimation/documented/runaway.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::documented::runaway {

void update_reference(RunawayState& state, const TimedFix& fix, const FixAssessment& assessment) {
  if (assessment.outlier && !assessment.forced) {
    state.fix_position_world_m += assessment.rival_step_world_m;
  } else {
    state = {true, fix.shifted_position_world_m};
  }
}

void damp(const RunawaySettings& settings, const RunawayState& state, Kinematics& body, double dt_s) {
  if (!state.has_fix) return;
  const Vector3d away_world_m = body.position_world_m - state.fix_position_world_m;
  const double beyond = away_world_m.norm() / settings.position_error_m - 1.0;
  if (beyond <= 0.0 || away_world_m.dot(body.velocity_world_mps) <= 0.0) return;
  const double rate_hz = settings.velocity_damp_max_hz * std::min(1.0, beyond);
  body.velocity_world_mps *= std::exp(-rate_hz * dt_s);
}

}  // namespace sonopose::estimation::documented::runaway
