#pragma once
/// \file
/// Items 5 and 31–34: yaw from the heading of paired beacons, and from the direction of motion.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/velocity.hpp>

namespace sonopose::estimation::documented {

struct HeadingSettings {
  double mount_offset_deg{};
  double min_displacement_m{};
  double max_correction_deg{};
  double error_gain{};
  double pair_gain_hz{};
  double pair_bias_gain_hz2{};
  double expires_s{};

  static constexpr std::string_view group = "heading";
  static constexpr auto declarations() {
    using G = HeadingSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(5, "mount_offset_deg", &G::mount_offset_deg, 0.0, {-360.0, 360.0}, "deg",
             "Angle from the body's X axis to the axis of the paired beacons; 90 where the pair stands along "
             "body "
             "Y."),
        real(31, "min_displacement_m", &G::min_displacement_m, 0.1, {0.0, 100.0}, "m",
             "Least distance between two fixes for a yaw correction from the direction of motion."),
        real(32, "max_correction_deg", &G::max_correction_deg, 5.0, {0.0, 180.0}, "deg",
             "Largest yaw correction by one fix."),
        real(33, "error_gain", &G::error_gain, 0.005, {0.0, 1.0}, "",
             "Share of the heading error that one fix corrects."),
        real(34, "pair_gain_hz", &G::pair_gain_hz, 2.0, {0.0, 50.0}, "1/s",
             "Rate at which yaw is pulled to the heading of the paired beacons, at every IMU sample."),
        real(
            own_setting, "pair_bias_gain_hz2", &G::pair_bias_gain_hz2, 0.15, {0.0, 10.0}, "1/s^2",
            "Rate at which a yaw-rate offset is learned from that pull; tilt's integral (item 30) cannot see "
            "one. No more of it acts than the pull (item 34) can damp, a quarter of its square."),
        real(own_setting, "expires_s", &G::expires_s, 0.5, {0.01, 60.0}, "s",
             "A paired heading is no longer valid this long after its last sample."));
  }
  constexpr HeadingSettings() { settings::set_defaults(*this); }
};

struct HeadingState {
  bool known = false;                ///< a valid heading has set yaw at least once
  TimeNs last_received_ns = 0;       ///< of the last valid heading
  double wanted_correction_rad = 0;  ///< the yaw correction at which yaw would agree with that heading
  double rate_offset_radps = 0;      ///< learned yaw-rate offset, about world Z

  bool operator==(const HeadingState&) const = default;
};

namespace heading {

/// Turns the body about the vertical and remembers that it was a correction.
void turn(Kinematics& body, attitude::AnyFilter& filter, double angle_rad);

/// Whether a paired heading holds at `now_ns`.
[[nodiscard]] bool is_valid(const HeadingSettings& settings, const HeadingState& state, TimeNs now_ns);

/// Takes a heading: body yaw = pair axis − mount offset, compared with the yaw when it was measured. The
/// first one sets yaw outright.
void take(const HeadingSettings& settings, HeadingState& state, Kinematics& body, attitude::AnyFilter& filter,
          const PairHeading& heading, TimeNs measured_ns);

/// One IMU step of the continuous pull (item 34). Returns the share of the yaw error that it took away.
double correct_from_pair(const HeadingSettings& settings, HeadingState& state, Kinematics& body,
            attitude::AnyFilter& filter, double dt_s);

/// Items 31–33: turns yaw by a share of the angle from the IMU's to the ultrasound's direction of motion.
/// Returns the turn (rad). Does nothing while a paired heading holds: that one is absolute.
double correct_from_course(const HeadingSettings& settings, const HeadingState& state, Kinematics& body,
             attitude::AnyFilter& filter, const FixVelocity& measured);

}  // namespace heading
}  // namespace sonopose::estimation::documented
