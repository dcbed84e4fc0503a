#include <sonopose/estimation/documented/scatter.hpp>

#include <algorithm>

namespace sonopose::estimation::documented::scatter {

void learn(ScatterState& state, const Kinematics& body, const TimedFix& fix) {
  constexpr double median = 1.65;         // of |n₁ − 2 n₂ + n₃|, in standard deviations of n
  constexpr double max_interval_s = 0.3;  // over a longer interval the acceleration of an IMU is wrong too
  constexpr double max_m = 10.0;
  const double interval_s = seconds_between(state.last_measured_ns, fix.measured_ns);
  const auto moved_world_m = body.displacement_between(state.last_measured_ns, fix.measured_ns);
  if (state.last_measured_ns != 0 && moved_world_m && interval_s > 0.0 && interval_s < max_interval_s) {
    const Vector3d excess_world_mps =
        (fix.measured_position_world_m - state.last_position_world_m - *moved_world_m) / interval_s +
        body.velocity_corrections_world_mps;
    const Vector3d aside_m =
        (interval_s * (excess_world_mps - state.last_excess_world_mps)).cwiseAbs() / median;
    state.last_excess_world_mps = excess_world_mps;
    // The first interval has none before it; the second begins the median.
    if (state.learned == 1) state.noise_world_m = aside_m;
    if (state.learned > 0) {
      const double factor = 1.0 + 1.0 / state.learned;
      for (int i = 0; i < 3; ++i) {
        const double noise_m =
            state.noise_world_m[i] * (aside_m[i] > state.noise_world_m[i] ? factor : 1.0 / factor);
        state.noise_world_m[i] = std::clamp(noise_m, ScatterState::min_m, max_m);
      }
    }
    state.learned = std::min(state.learned + 1, ScatterState::samples_to_learn);
  }
  state.last_measured_ns = fix.measured_ns;
  state.last_position_world_m = fix.measured_position_world_m;
}

void scale_innovation(const Vector3d& share, const Kinematics& body, TimedFix& fix) {
  const Vector3d distance_world_m = fix.shifted_position_world_m - body.position_world_m;
  const Vector3d moved_world_m = share.cwiseProduct(distance_world_m) - distance_world_m;
  fix.measured_position_world_m += moved_world_m;
  fix.shifted_position_world_m += moved_world_m;
  fix.share = share;
}

}  // namespace sonopose::estimation::documented::scatter
