#pragma once
/// \file
/// Item 1: the overall balance between the IMU and the ultrasound, as a preset of items 2, 3 and 4.

#include <sonopose/settings/settings.hpp>

namespace sonopose::settings {

/// Items 2, 3 and 4 as one preset sets them.
struct Balance {
  double decay_rate_hz;
  double blend_weight;
  double jump_alpha;
};

/// The values of a preset. `user` has none; for it the result is that of `medium`.
Balance balance_of(ImuWeight weight);

/// The settings that the engine uses: unless the preset is `user`, its values replace items 2, 3 and 4.
Settings resolved(Settings settings);

}  // namespace sonopose::settings
