#pragma once
/// \file
/// Alignment in motion, beyond the document. Velocity corrections by fixes reveal attitude errors: a tilt
/// error causes a spurious acceleration, a yaw error rotates the true one. This allows a low gain in item 29,
/// so that long turns do not disturb the tilt. It also lets a single beacon find its heading by moving.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/velocity.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::AlignmentSettings;

struct AlignmentState {
  double vertical_offset_mps2 = 0;  ///< offset added to the vertical acceleration
  /// Velocity gained by the IMU's acceleration, reduced by the share that each fix corrects.
  Vector3d gained_world_mps = Vector3d::Zero();
  /// Velocity corrections not yet passed to the attitude filter as acceleration.
  Vector3d pending_world_mps = Vector3d::Zero();
  /// Acceleration of the last step, for the attitude filter.
  Vector3d known_acceleration_world_mps2 = Vector3d::Zero();
  bool aiding = false;  ///< true while the filter uses the acceleration
  TimeNs aided_ns = 0;  ///< time when the filter last used it; 0: never
  TimeNs gated_ns = 0;  ///< time when the gate (items 35–37) last withheld acceleration; 0: never

  bool operator==(const AlignmentState&) const = default;
};

/// A correction of yaw by a fix.
struct YawTurn {
  double turn_rad = 0;
  double share = 0;    ///< share of the yaw error that was certainly removed; 0: unknown
  double std_rad = 0;  ///< standard deviation of the measured yaw, if `share` is positive
};

namespace alignment {

/// Levels the attitude after a velocity change dv by a fix. A horizontal one turns the attitude by gain · dv
/// / g about the horizontal axis perpendicular to dv. A vertical one changes the offset by gain · dv.
void correct_tilt(const AlignmentSettings& settings, AlignmentState& state, attitude::AnyFilter& filter,
                  const Vector3d& velocity_change_world_mps);

/// Performs one IMU step, in which acceleration has added `gained_world_mps` to a velocity that fixes
/// correct.
void set_known_acceleration(const AlignmentSettings& settings, AlignmentState& state,
                            const Vector3d& gained_world_mps, TimeNs now_ns, double dt_s);

/// Performs one IMU step whose acceleration the gate withheld: it is unknown, and fixes that measure the
/// missing velocity show no error of the attitude.
void suspend(AlignmentState& state, TimeNs now_ns);

/// Marks the acceleration as unknown, like the velocity.
void clear_known_acceleration(AlignmentState& state);

/// Adds the known acceleration to `measurement`, made at `now_ns`. For hold_s after the acceleration was last
/// known, the specific force is not used as the vertical.
void add_known_acceleration(const AlignmentSettings& settings, const AlignmentState& state, TimeNs now_ns,
                            attitude::Measurement<double>& measurement);

/// Turns yaw, and the velocity with it, by a share of the angle from the gained velocity g to g + (v_us −
/// v_imu), the gain that the fixes have measured. `share` is the share of v_us − v_imu that the fix has
/// corrected. The turn is small without acceleration.
YawTurn correct_yaw(const AlignmentSettings& settings, AlignmentState& state, Kinematics& body,
                    attitude::AnyFilter& filter, const FixVelocity& measured, double share);

}  // namespace alignment
}  // namespace sonopose::estimation::documented
