#include "ros2/relay/autopilot_output.hpp"

#include "autopilot/ardupilot.hpp"
#include "autopilot/px4.hpp"
#include "clocks/clocks.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

namespace sonopose::ros2::relay {

using autopilot::NotSent;

AutopilotOutput::AutopilotOutput(ros2::Node& node, const AutopilotOptions& options)
    : is_px4_(options.kind == AutopilotOptions::Kind::px4),
      name_(is_px4_ ? "PX4" : "ArduPilot"),
      pose_topic_(options.name_space + (is_px4_ ? "/fmu/in/vehicle_visual_odometry" : "/tf")),
      clock_topic_(options.name_space + (is_px4_ ? "/fmu/out/timesync_status" : "/clock")),
      north_(options.north_rad),
      rate_(options.rate_hz),
      posed_(clocks::steady_now()) {
  if (is_px4_) {
    odometry_writer_ = node.make_writer<ros2::VehicleOdometry>(pose_topic_, "ros2::Default");
    timesync_reader_ = node.make_reader<ros2::TimesyncStatus>(clock_topic_, "ros2::Input", &px4_listener_);
  } else {
    tf_writer_ = node.make_writer<ros2::TFMessage>(pose_topic_, "ros2::Default");
    clock_reader_ = node.make_reader<ros2::Clock>(clock_topic_, "ros2::Input", &clock_listener_);
  }
}

void AutopilotOutput::on(const ros2::TimesyncStatus& status) {
  if (status.timestamp >= static_cast<std::uint64_t>(end_of_time_ns / 1000)) return;
  on_stamp(static_cast<TimeNs>(status.timestamp) * 1000);
}

void AutopilotOutput::on(const ros2::Clock& message) {
  if (const auto time_ns = ros2::from_ros(message.clock)) on_stamp(*time_ns);
}

void AutopilotOutput::on_stamp(TimeNs stamp_ns) {
  constexpr TimeNs year_2001_ns = 1'000'000'000'000'000'000;
  const threads::Lock lock(mutex_);
  clock_.on(stamp_ns, clocks::host_now(), clocks::steady_now());
  has_unix_clock_ = stamp_ns > year_2001_ns;
}

void AutopilotOutput::on(const FusedPose& pose, const std::optional<ros2::Mount>& mount) {
  const auto due_pose = due(pose, mount);
  if (!due_pose) return;
  if (is_px4_) {
    dds::ext::try_write(odometry_writer_, autopilot::vehicle_odometry(
                                              due_pose->odometry, due_pose->measured_ns, due_pose->now_ns,
                                              due_pose->reset_counter, due_pose->quality_percent));
    return;
  }
  static const autopilot::ArduPilotFrames frames;
  ros2::TransformStamped transform =
      autopilot::ardupilot_transform(due_pose->odometry, due_pose->measured_ns, frames);
  dds::ext::try_write(tf_writer_, ros2::TFMessage{{1, 1, &transform, false}});
}

std::optional<AutopilotOutput::Due> AutopilotOutput::due(const FusedPose& pose,
                                                         const std::optional<ros2::Mount>& mount) {
  const threads::Lock lock(mutex_);
  if (!address_) address_ = pose.address;
  if (*address_ != pose.address) {
    other_ = pose.address;
    return std::nullopt;
  }
  const SteadyTime now = clocks::steady_now();
  posed_ = now;
  const auto verdict = gate_.on(pose);
  const HostTime host_ns = clocks::host_now();
  state_ = verdict.not_sent;
  if (state_ == NotSent::none && !mount) state_ = NotSent::no_mount;
  if (state_ == NotSent::none && !autopilot::is_of_clock(pose.time_ns, host_ns))
    state_ = NotSent::other_clock;
  if (state_ != NotSent::none) return std::nullopt;
  const auto odometry = autopilot::external_odometry(pose, *mount, north_);
  const auto measured_ns = clock_.at(pose.time_ns, now);
  const auto now_ns = clock_.at(host_ns, now);
  const bool has_clock = measured_ns && now_ns;
  state_ = reason_not_sent(odometry, has_clock);
  if (state_ != NotSent::none || !stamp_.next(pose.time_ns) || !rate_.admits(pose.time_ns)) {
    return std::nullopt;
  }
  return Due{odometry, *measured_ns, *now_ns, gate_.take_reset_counter(), verdict.quality_percent};
}

/// Reason to send nothing that does not lie in the poses.
NotSent AutopilotOutput::reason_not_sent(const autopilot::ExternalOdometry& odometry, bool has_clock) const {
  if (!has_clock) return NotSent::no_clock;
  if (!is_px4_ && has_unix_clock_) return NotSent::unix_clock;
  if (!is_px4_) return ardupilot_not_sent(odometry, false);
  return !north_ && !odometry.q_body_to_frame ? NotSent::yaw_unknown : NotSent::none;
}

/// State of the last pose, unless the poses or the clock have ended since.
std::optional<NotSent> AutopilotOutput::state_at(SteadyTime now) const {
  if (now - posed_ > autopilot::no_poses_after_ns) return NotSent::no_poses;
  if (state_ == NotSent::none && !clock_.at(clocks::host_now(), now)) return NotSent::no_clock;
  return state_;
}

void AutopilotOutput::log_changes() {
  std::optional<NotSent> state;
  std::optional<BeaconAddress> other;
  std::optional<BeaconAddress> address;
  {
    const threads::Lock lock(mutex_);
    state = state_at(clocks::steady_now());
    other = other_;
    address = address_;
  }
  if (other && !logged_others_) {
    logging::warning(
        fmt::format("{} gets the poses of beacon {}; those of others, such as {}, are not sent: "
                    "--addresses selects it",
                    name_, *address, *other));
    logged_others_ = true;
  }
  if (state == logged_) return;
  logged_ = state;
  if (state == NotSent::none) {
    logging::info(fmt::format("{}: sending the poses of beacon {} on {}", name_, *address, pose_topic_));
  } else if (state == NotSent::no_clock) {
    logging::warning(
        fmt::format("{}: not sending poses, because its clock is unknown: nothing arrives on {}; "
                    "are autopilot and Micro-XRCE-DDS agent connected?",
                    name_, clock_topic_));
  } else {
    const std::string of_beacon = address ? fmt::format(" of beacon {}", *address) : "";
    logging::warning(fmt::format("{}: not sending poses{}: {}", name_, of_beacon, text_of(*state)));
  }
}

}  // namespace sonopose::ros2::relay
