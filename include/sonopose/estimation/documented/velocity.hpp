#pragma once
/// \file
/// Items 3, 7, 8 and 26–28: how the velocity follows the fixes.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/trust.hpp>

#include <array>
#include <cstdint>
#include <optional>

namespace sonopose::estimation::documented {

struct VelocitySettings {
  double blend_weight{};
  bool overshoot_fix{};
  bool undershoot_fix{};
  double snap_min_speed_mps{};
  double snap_max_bend_m{};
  bool accel_gate{};
  double accel_gate_threshold_mps2{};
  double interval_min_s{};
  double interval_max_s{};
  double interval_wanted_s{};

  static constexpr std::string_view group = "velocity";
  static constexpr auto declarations() {
    using G = VelocitySettings;
    using settings::flag;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(3, "blend_weight", &G::blend_weight, 0.14, {0.0, 1.0}, "",
             "Largest share of the difference to the velocity between two fixes that one fix corrects; "
             "scaled by "
             "the fix's weight."),
        flag(7, "overshoot_fix", &G::overshoot_fix, true,
             "Take the ultrasonic velocity at once where the IMU's is more than twice as high in the same "
             "direction."),
        flag(8, "undershoot_fix", &G::undershoot_fix, true,
             "Take the ultrasonic velocity at once where it is more than twice the IMU's."),
        real(28, "snap_min_speed_mps", &G::snap_min_speed_mps, 2.0, {0.0, 100.0}, "m/s",
             "Ultrasonic speed below which the overshoot and undershoot fixes never act."),
        real(own_setting, "snap_max_bend_m", &G::snap_max_bend_m, 0.08, {0.0, 100.0}, "m",
             "A fix farther than this from the straight continuation of the two before it takes no velocity "
             "at "
             "once: one stray fix is no speed."),
        flag(26, "accel_gate", &G::accel_gate, false,
             "Reduce the velocity correction in proportion to the current acceleration."),
        real(27, "accel_gate_threshold_mps2", &G::accel_gate_threshold_mps2, 3.0, {0.01, 1000.0}, "m/s^2",
             "Acceleration at which the acceleration gate halves the correction; at twice this it is zero."),
        real(own_setting, "interval_min_s", &G::interval_min_s, 0.05, {0.001, 1.0}, "s",
             "Two fixes closer together than this give no velocity."),
        real(own_setting, "interval_max_s", &G::interval_max_s, 0.5, {0.01, 10.0}, "s",
             "Two fixes farther apart than this give no velocity."),
        real(own_setting, "interval_wanted_s", &G::interval_wanted_s, 0.15, {0.001, 10.0}, "s",
             "Of the earlier fixes the velocity is measured from the latest that lies this far back, else "
             "from the oldest: over a longer interval the fixes' noise counts less."));
  }
  constexpr VelocitySettings() { settings::set_defaults(*this); }
};

/// One good fix of the past.
struct PastFix {
  TimeNs measured_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();

  bool operator==(const PastFix&) const = default;
};

/// The latest good fixes, newest first, from which the next velocity can be measured.
struct VelocityState {
  static constexpr int capacity = 8;
  std::array<PastFix, capacity> fixes;
  int count = 0;
  int velocities =
      0;  ///< that the run has corrected the velocity by; none counts for more than the first few

  /// Whether the velocity is known as well as it will be, and not still averaged over the run's first ones.
  static constexpr int enough_velocities = 7;
  [[nodiscard]] bool settled() const { return velocities >= enough_velocities; }
  void settle() { velocities = enough_velocities; }
  void unsettle() { velocities = 0; }

  bool operator==(const VelocityState&) const = default;
};

/// The velocity between two fixes, and the IMU's mean over the same interval.
struct FixVelocity {
  Vector3d ultrasonic_world_mps = Vector3d::Zero();
  Vector3d inertial_world_mps = Vector3d::Zero();
  Vector3d displacement_world_m = Vector3d::Zero();  ///< between the two fixes
  double interval_s = 0;                             ///< between the two fixes
  double bend_m = 0;  ///< from the straight continuation of the two fixes before; infinite without them
};

/// What a fix did to the velocity.
struct VelocityChange {
  Vector3d change_world_mps = Vector3d::Zero();
  double share = 1;           ///< of the difference between the two velocities that was corrected
  std::uint32_t flags = 0;  ///< fix_snapped_over, fix_snapped_under
};

namespace velocity {

/// Begins a run of fixes with this one, of a body whose velocity is known already or not.
void restart(VelocityState& state, const TimedFix& fix, bool velocity_known);

/// Measures the velocity from an earlier good fix to this one and remembers this one where it is good, that
/// is no outlier, or one of a convergence that is forced. Empty where there is none at the right distance in
/// time, or where the track begins anew: from the old track to the new one nothing has moved.
[[nodiscard]] std::optional<FixVelocity> measure(const VelocitySettings& settings, VelocityState& state,
                                                 const Kinematics& body, const TimedFix& fix,
                                                 const FixAssessment& assessment);

/// Corrects the velocity: v += blend · reliability · (v_us − mean v_imu), or at once where a snap applies.
/// The first velocities of a run are averaged.
VelocityChange correct(const VelocitySettings& settings, VelocityState& state, Kinematics& body,
                       const FixVelocity& measured, const FixAssessment& assessment);

/// Takes the measured velocity outright: the second fix after stale mode.
Vector3d adopt(VelocityState& state, Kinematics& body, const FixVelocity& measured);

}  // namespace velocity
}  // namespace sonopose::estimation::documented
