#pragma once
/// \file
/// Items 2, 4 and 9: how the position follows a fix: a part at once, the rest through a second-order decay.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/trust.hpp>

namespace sonopose::estimation::documented {

struct DriftSettings {
  double decay_rate_hz{};
  double jump_alpha{};
  double velocity_smooth_rate_hz{};

  static constexpr std::string_view group = "drift";
  static constexpr auto declarations() {
    using G = DriftSettings;
    using settings::real;
    return settings::rows(
        real(2, "decay_rate_hz", &G::decay_rate_hz, 1.5, {0.0, 50.0}, "1/s",
             "Rate at which the offset between the IMU's path and the ultrasonic track is driven to zero."),
        real(4, "jump_alpha", &G::jump_alpha, 0.32, {0.0, 1.0}, "",
             "Share of the discrepancy at a fix that is applied at once, scaled by the fix's weight."),
        real(9, "velocity_smooth_rate_hz", &G::velocity_smooth_rate_hz, 10.0, {0.1, 200.0}, "1/s",
             "Smoothing rate of the drift velocity, the inner loop of the decay; it rings where item 2 "
             "exceeds a "
             "quarter of it."));
  }
  constexpr DriftSettings() { settings::set_defaults(*this); }
};

struct DriftState {
  Vector3d offset_world_m = Vector3d::Zero();      ///< d: still to be spent
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< u: at which it is being spent
  double weight = 0;                               ///< of the fix that set d

  bool operator==(const DriftState&) const = default;
};

namespace drift {

/// The share of the discrepancy that a fix removes at once (item 4, or item 21 where it is more).
[[nodiscard]] double jump_share(const DriftSettings& settings, const FixAssessment& assessment);

/// A fix: p += jump · e at once; the rest *replaces* d. Offsets never add up. Returns the jump.
Vector3d correct(const DriftSettings& settings, DriftState& state, Kinematics& body, const TimedFix& fix,
                 const FixAssessment& assessment);

/// One IMU step: u follows u* = decay · w · d at the smoothing rate; p += u·dt, d −= u·dt.
void apply_decay(const DriftSettings& settings, DriftState& state, Kinematics& body, double dt_s);

}  // namespace drift
}  // namespace sonopose::estimation::documented
