#pragma once
/// \file
/// Decides whether an autopilot gets a pose, with which quality, and whether it has jumped.

#include <sonopose/samples/pose.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::autopilot {

/// Reason why an autopilot gets no pose. Its own estimator then coasts, and its failsafe takes over.
enum class NotSent : std::uint8_t {
  none,
  no_poses,      ///< no pose has arrived for `no_poses_after_ns`
  no_position,   ///< initialising, or the position's deviation is unknown
  late,          ///< the IMU sample of the pose is old
  other_clock,   ///< the pose is stamped far from the time of this host
  doubtful,      ///< stale, untrusted or inconsistent for `silent_after_s`, or not settled yet
  no_mount,      ///< the pose of the IMU on the vehicle is unknown
  yaw_unknown,   ///< and the axes of the frame mean nothing without it
  no_velocity,   ///< the velocity is unknown, and the autopilot would take NaN
  no_autopilot,  ///< no heartbeats of an autopilot
  no_clock,      ///< the autopilot's clock is not known, or no longer
  unix_clock,    ///< the autopilot's clock counts from 1970, where it needs the time since its start
};

/// Time without poses after which that is logged.
inline constexpr TimeNs no_poses_after_ns = 3'000'000'000;

/// Text for the log: "no position".
const char* text_of(NotSent reason);

/// True if a pose that arrives now can be stamped by this host's clock, which the stamps for autopilots are
/// made from. A recording has other stamps, and so has a bridge elsewhere whose clock is not synchronised.
constexpr bool is_of_clock(TimeNs pose_ns, HostTime now) {
  constexpr TimeNs max_difference_ns = 1'000'000'000;
  const TimeNs age_ns = saturated_difference(now, pose_ns);
  return age_ns <= max_difference_ns && age_ns >= -max_difference_ns;
}

/// Lets the good poses of one beacon pass. Give it each of them, also those that are not sent.
class ExternalVisionGate {
public:
  /// Doubt after which nothing is sent. The quality falls linearly until then.
  static constexpr double silent_after_s = 3;
  /// Time without doubt before the first pose is sent: at the start, and after such a silence, a pause or a
  /// lost position. Jumps meanwhile are one.
  static constexpr double settled_after_s = 0.5;
  /// Time without poses that is a pause.
  static constexpr double pause_s = 1;
  /// Steps between two poses, beyond their motion, that count as a jump.
  static constexpr double jump_m = 0.3;
  static constexpr double jump_rad = 0.17;

  struct Verdict {
    NotSent not_sent = NotSent::none;
    std::uint8_t quality_percent = 1;  ///< 1…100
  };
  Verdict on(const FusedPose& pose);

  /// Counter for the pose that is sent now: one more if the estimate has jumped since the last call, however
  /// often.
  std::uint8_t take_reset_counter();

private:
  [[nodiscard]] bool has_jumped(const FusedPose& pose) const;

  std::optional<FusedPose> last_;  ///< with or without a position
  std::optional<TimeNs> doubtful_since_;
  std::optional<TimeNs> good_since_;  ///< without doubt
  bool is_settled_ = false;
  bool jumped_ = false;
  std::uint8_t reset_counter_ = 0;
};

}  // namespace sonopose::autopilot
