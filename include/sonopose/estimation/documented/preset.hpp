#pragma once
/// \file
/// Item 1: the overall balance between the IMU and the ultrasound, as a preset of items 2, 3 and 4.

#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/drift.hpp>
#include <sonopose/estimation/documented/velocity.hpp>

#include <array>
#include <string_view>

namespace sonopose::estimation::documented {

enum class ImuWeight { low, medium, high, user };
constexpr std::array<std::string_view, 4> choices_of(ImuWeight /*unused*/) {
  return {"low", "medium", "high", "user"};
}

struct PresetSettings {
  ImuWeight imu_weight{};

  static constexpr std::string_view group = "fusion";
  static constexpr auto declarations() {
    using G = PresetSettings;
    return settings::rows(settings::choice(
        1, "imu_weight", &G::imu_weight, ImuWeight::medium,
        "Balance of IMU and ultrasound: low follows the fixes closely, high is smooth and corrects slowly; "
        "user takes items 2, 3 and 4 as they are set."));
  }
  constexpr PresetSettings() { settings::set_defaults(*this); }
};

/// Items 2, 3 and 4 as one preset sets them.
struct Balance {
  double decay_rate_hz;
  double blend_weight;
  double jump_alpha;
};

/// What a preset stands for; `user` has no values of its own and must not be asked for.
Balance balance_of(ImuWeight weight);

/// Puts the preset's values in the place of the user's, unless the preset is `user`.
void apply_preset(const PresetSettings& preset, DriftSettings& drift, VelocitySettings& velocity);

}  // namespace sonopose::estimation::documented
