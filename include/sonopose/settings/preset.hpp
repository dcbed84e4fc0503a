#pragma once
/// \file
/// Item 1: the overall balance between the IMU and the ultrasound, as a preset of items 2, 3 and 4.

#include <sonopose/settings/settings.hpp>

namespace sonopose::settings {

/// Items 2, 3 and 4 of one preset.
struct Balance {
  double decay_rate_hz;
  double blend_weight;
  double jump_alpha;
};

/// Values of a preset. `user` has none and returns those of `medium`.
Balance balance_of(ImuWeight weight);

/// Effective settings: unless the preset is `user`, its values replace items 2, 3 and 4.
Settings resolved(Settings settings);

}  // namespace sonopose::settings
