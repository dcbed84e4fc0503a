#pragma once
/// \file
/// Items 5 and 31–34: yaw from the heading of paired beacons, and from the direction of motion.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/velocity.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::HeadingSettings;

struct HeadingState {
  bool known = false;                ///< true once a valid heading has set yaw
  TimeNs last_received_ns = 0;       ///< receipt time of the last valid heading
  double wanted_correction_rad = 0;  ///< yaw correction with which yaw agrees with that heading
  double rate_offset_radps = 0;      ///< learned yaw-rate offset, about world Z

  bool operator==(const HeadingState&) const = default;
};

namespace heading {

/// Yaw shown by the pair: the direction of its axis minus the mount offset. It is the body's yaw while the
/// body is level. Otherwise the axis leaves that direction, unless it is body X.
[[nodiscard]] double yaw_by_pair(const HeadingSettings& settings, const Quaterniond& q_body_to_world);

/// Turns the body about the vertical and records the turn as a correction.
void turn(Kinematics& body, attitude::AnyFilter& filter, double angle_rad);

/// True if a paired heading is valid at `now_ns`.
[[nodiscard]] bool is_valid(const HeadingSettings& settings, const HeadingState& state, TimeNs now_ns);

/// Sets the target yaw from a heading: the turn that takes the pair's axis, as at the measurement, to it. The
/// first heading sets yaw directly.
void set_target(const HeadingSettings& settings, HeadingState& state, Kinematics& body,
                attitude::AnyFilter& filter, const PairHeading& heading, TimeNs measured_ns);

/// Performs one IMU step of the continuous correction (item 34). Returns the share of the yaw error that it
/// removed.
double correct_from_pair(const HeadingSettings& settings, HeadingState& state, Kinematics& body,
                         attitude::AnyFilter& filter, double dt_s);

/// Items 31–33: turns yaw by a share of the angle from the IMU's to the ultrasound's direction of motion.
/// Returns the turn (rad). Does nothing while a paired heading, which is absolute, is valid.
double correct_from_course(const HeadingSettings& settings, const HeadingState& state, Kinematics& body,
                           attitude::AnyFilter& filter, const FixVelocity& measured);

}  // namespace heading
}  // namespace sonopose::estimation::documented
