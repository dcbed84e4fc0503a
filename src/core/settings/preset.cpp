#include <sonopose/settings/preset.hpp>

namespace sonopose::settings {

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
  // The defaults of items 2–4 are those of medium.
  return {.decay_rate_hz = DriftSettings{}.decay_rate_hz,
          .blend_weight = VelocitySettings{}.blend_weight,
          .jump_alpha = DriftSettings{}.jump_alpha};
}

Settings resolved(Settings settings) {
  if (settings.preset.imu_weight == ImuWeight::user) return settings;
  const Balance balance = balance_of(settings.preset.imu_weight);
  settings.drift.decay_rate_hz = balance.decay_rate_hz;
  settings.drift.jump_alpha = balance.jump_alpha;
  settings.velocity.blend_weight = balance.blend_weight;
  return settings;
}

}  // namespace sonopose::settings
