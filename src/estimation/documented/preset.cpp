#include <sonopose/estimation/documented/preset.hpp>

namespace sonopose::estimation::documented {

Balance balance_of(ImuWeight weight) {
  switch (weight) {
    case ImuWeight::low:
      return {.decay_rate_hz = 4.0, .blend_weight = 0.40, .jump_alpha = 0.60};
    case ImuWeight::high:
      return {.decay_rate_hz = 0.7, .blend_weight = 0.07, .jump_alpha = 0.15};
    case ImuWeight::medium:
    case ImuWeight::user:
      break;
  }
  // Medium is what the defaults of items 2–4 are: they stand there, once.
  return {.decay_rate_hz = DriftSettings{}.decay_rate_hz,
          .blend_weight = VelocitySettings{}.blend_weight,
          .jump_alpha = DriftSettings{}.jump_alpha};
}

void apply_preset(const PresetSettings& preset, DriftSettings& drift, VelocitySettings& velocity) {
  if (preset.imu_weight == ImuWeight::user) return;
  const Balance balance = balance_of(preset.imu_weight);
  drift.decay_rate_hz = balance.decay_rate_hz;
  drift.jump_alpha = balance.jump_alpha;
  velocity.blend_weight = balance.blend_weight;
}

}  // namespace sonopose::estimation::documented
