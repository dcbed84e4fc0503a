#pragma once
/// \file
/// In-motion alignment, beyond the document: what the fixes must correct of the velocity again and again
/// tells how the attitude is wrong. A tilt that is off makes an acceleration that is not there; a yaw that is
/// off turns the accelerations that are. With it item 29 can be so low that long turns do not mislead the
/// tilt, and a single beacon finds its heading by moving.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/velocity.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::AlignmentSettings;

struct AlignmentState {
  double vertical_offset_mps2 = 0;  ///< to be added to the vertical acceleration
  /// What the IMU's acceleration has added to the velocity, forgotten as fast as the fixes correct it.
  Vector3d gained_world_mps = Vector3d::Zero();
  /// Velocity corrections that the attitude filter has not been told of.
  Vector3d pending_world_mps = Vector3d::Zero();
  /// How the velocity has changed in the last step: what the filter is told.
  Vector3d known_acceleration_world_mps2 = Vector3d::Zero();
  bool tells = false;  ///< it is being told
  TimeNs told_ns = 0;  ///< when it was told last; 0: never

  bool operator==(const AlignmentState&) const = default;
};

namespace alignment {

/// A horizontal velocity change dv by a fix turns the attitude by gain · dv / g about the horizontal axis
/// across it, a vertical one changes the offset by gain · dv.
void level(const AlignmentSettings& settings, AlignmentState& state, attitude::AnyFilter& filter,
           const Vector3d& velocity_change_world_mps);

/// One IMU step, in which acceleration has added `gained_world_mps` to a velocity that the fixes hold.
void set_known_acceleration(const AlignmentSettings& settings, AlignmentState& state,
                            const Vector3d& gained_world_mps, TimeNs now_ns, double dt_s);

/// The velocity is not known: nor is the acceleration.
void clear_known_acceleration(AlignmentState& state);

/// Puts into `measurement`, made at `now_ns`, what is known of the acceleration. Where it was known a moment
/// ago and is no longer, the specific force does not tell up.
void aid(const AlignmentSettings& settings, const AlignmentState& state, TimeNs now_ns,
         attitude::Measurement<double>& measurement);

/// Turns yaw by a share of the angle from the gained velocity g to g + (v_us − v_imu), the gain that the
/// fixes have seen, and the velocity with it. `share` is how much of v_us − v_imu the fix has corrected.
/// Returns the turn (rad). Where nothing accelerates, nothing is learned.
double turn(const AlignmentSettings& settings, AlignmentState& state, Kinematics& body,
            attitude::AnyFilter& filter, const FixVelocity& measured, double share);

}  // namespace alignment
}  // namespace sonopose::estimation::documented
