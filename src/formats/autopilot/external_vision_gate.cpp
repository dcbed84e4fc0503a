#include "autopilot/external_vision_gate.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonopose::autopilot {
namespace {

constexpr std::uint32_t doubtful_statuses = status_stale | status_converging | status_frozen_track |
                                            status_imu_gap | status_low_trust | status_imu_inconsistent |
                                            status_fixes_inconsistent;

bool has_position(const FusedPose& pose) {
  return pose.time_ns > 0 && pose.time_ns < end_of_time_ns && (pose.status & status_initialising) == 0 &&
         pose.position_world_m.allFinite() && pose.q_body_to_world.coeffs().allFinite() &&
         pose.pose_covariance.is_known(0) && pose.pose_covariance.is_known(1) &&
         pose.pose_covariance.is_known(2);
}

}  // namespace

const char* text_of(NotSent reason) {
  switch (reason) {
    case NotSent::none:
      break;
    case NotSent::no_poses:
      return "no poses arrive";
    case NotSent::no_position:
      return "no position";
    case NotSent::late:
      return "the poses are late";
    case NotSent::other_clock:
      return "their stamps are more than 1 s from the time of this machine; synchronise the clocks, or play "
             "a recording with --restamp";
    case NotSent::doubtful:
      return "the poses are stale, untrusted or inconsistent, or not yet good for long enough";
    case NotSent::no_mount:
      return "the mount of the IMU is unknown";
    case NotSent::yaw_unknown:
      return "the yaw is unknown";
    case NotSent::no_velocity:
      return "the velocity is unknown; vision_position has none";
    case NotSent::no_autopilot:
      return "no heartbeats from an autopilot";
    case NotSent::no_clock:
      return "the autopilot's clock is unknown";
    case NotSent::unix_clock:
      return "the autopilot's clock is not the time since its start; set BRD_RTC_TYPES to 0";
  }
  return "";
}

ExternalVisionGate::Verdict ExternalVisionGate::on(const FusedPose& pose) {
  jumped_ = jumped_ || has_jumped(pose);
  const bool is_after_pause = last_ && std::abs(seconds_between(last_->time_ns, pose.time_ns)) > pause_s;
  last_ = pose;
  if (is_after_pause || !has_position(pose)) {
    is_settled_ = false;
    good_since_.reset();
  }
  if (!has_position(pose)) {
    doubtful_since_.reset();
    return {.not_sent = NotSent::no_position};
  }
  if ((pose.status & doubtful_statuses) == 0) {
    doubtful_since_.reset();
    if (!good_since_ || pose.time_ns < *good_since_) good_since_ = pose.time_ns;
    is_settled_ = is_settled_ || seconds_between(*good_since_, pose.time_ns) >= settled_after_s;
  } else {
    good_since_.reset();
    if (!doubtful_since_ || pose.time_ns < *doubtful_since_) doubtful_since_ = pose.time_ns;
  }
  if ((pose.status & status_late) != 0) return {.not_sent = NotSent::late};
  const double doubt_s = doubtful_since_ ? seconds_between(*doubtful_since_, pose.time_ns) : 0.0;
  is_settled_ = is_settled_ && doubt_s < silent_after_s;
  // A doubt at the start or after a pause may be old, and the first fixes after it still move the pose.
  if (!is_settled_) return {.not_sent = NotSent::doubtful};
  const double trust = std::clamp(pose.trust, 0.0, 1.0) * (1 - doubt_s / silent_after_s);
  const double percent = std::isfinite(trust) ? std::round(100 * trust) : 1.0;
  return {.quality_percent = static_cast<std::uint8_t>(std::clamp(percent, 1.0, 100.0))};
}

bool ExternalVisionGate::has_jumped(const FusedPose& pose) const {
  if (!last_) return false;
  if (pose.reset_counter != last_->reset_counter) return true;
  if (!has_position(*last_)) return false;  // a jump since the last position is noted already
  if (!has_position(pose)) return true;     // the next position is a new start
  const double step_s = seconds_between(last_->time_ns, pose.time_ns);
  if (step_s < 0) return true;  // the clock was set, or another fusion took over
  const Vector3d moved_m = pose.position_world_m - last_->position_world_m;
  const Vector3d mean_velocity_mps = 0.5 * (pose.velocity_world_mps + last_->velocity_world_mps);
  if (!((moved_m - step_s * mean_velocity_mps).norm() <= jump_m)) return true;
  if (((pose.status | last_->status) & status_heading_unknown) != 0) return false;
  const Quaterniond expected =
      last_->q_body_to_world * geometry::rotation_by(Vector3d(step_s * pose.angular_velocity_body_radps));
  return !(expected.angularDistance(pose.q_body_to_world) <= jump_rad);
}

std::uint8_t ExternalVisionGate::take_reset_counter() {
  if (std::exchange(jumped_, false)) ++reset_counter_;
  return reset_counter_;
}

}  // namespace sonopose::autopilot
