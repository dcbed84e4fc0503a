#include "ros2/inputs/input_monitor.hpp"

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sonopose::ros2 {
namespace {

using text::count_text;

constexpr TimeNs loss_report_period_ns = 1'000'000'000;
/// Bounds log lines about a sender that uses a new frame for each message.
constexpr std::size_t max_unexpected_frames = 8;

const char* noun_of(Input::Kind kind) {
  switch (kind) {
    case Input::Kind::imu:
      return "IMU samples";
    case Input::Kind::fix:
      return "fixes";
    case Input::Kind::twist:
      return "velocities";
    case Input::Kind::heading:
      return "headings";
    case Input::Kind::pose:
      return "poses";
  }
  return "";
}

}  // namespace

InputMonitor::InputMonitor(Input input, std::string map_frame, TimeNs timeout_ns, SteadyTime now)
    : input_(std::move(input)), timeout_ns_(timeout_ns), latest_(now) {
  if (input_.kind == Input::Kind::fix) expected_frame_ = std::move(map_frame);
}

void InputMonitor::on_sample(std::string_view frame, SteadyTime now, Lines& lines) {
  received_ = true;
  latest_ = now;
  frame = without_slash(frame);
  if (!expected_frame_) expected_frame_ = frame;
  if (frame != *expected_frame_) log_unexpected_frame(frame, lines);
}

void InputMonitor::update(const InputEndpoints& endpoints, SteadyTime now, Lines& lines) {
  check_silence(endpoints, now, lines);
  check_losses(endpoints, now, lines);
}

void InputMonitor::check_silence(const InputEndpoints& endpoints, SteadyTime now, Lines& lines) {
  const bool was_silent = silence_.has_value();
  if (now - latest_ > (received_ ? timeout_ns_ : std::max(timeout_ns_, first_sample_ns))) {
    if (!was_silent) silence_ = Silence{latest_, !received_};
    // A new incompatible publisher is the probable cause, so report again.
    const bool has_new_cause =
        endpoints.publishers == 0 && endpoints.publishers_incompatible > reported_incompatible_;
    if (!was_silent || has_new_cause) log_silence(endpoints, now, lines);
  } else if (was_silent) {
    const auto text = [this, silence = *silence_, end = latest_] {
      return fmt::format("beacon {}: {} from ROS 2{}, after {:.1f} s", input_.address, samples_text(),
                         silence.is_first ? "" : " again", seconds_between(silence.since, end));
    };
    lines.push_back({text, logging::Level::info});
    silence_.reset();
  }
}

void InputMonitor::log_silence(const InputEndpoints& endpoints, SteadyTime now, Lines& lines) {
  const bool is_partial =
      noticed_.contains(Notice::no_angular_velocity) || noticed_.contains(Notice::no_specific_force);
  lines.push_back({[this, endpoints, now, silence = *silence_, is_partial] {
    const std::string lasted =
        silence.is_first ? "yet" : fmt::format("for {:.1f} s", seconds_between(silence.since, now));
    return fmt::format("beacon {}: no {} from ROS 2 {}: {}", input_.address, samples_text(), lasted,
                       cause(endpoints, is_partial));
  }});
  reported_incompatible_ = endpoints.publishers_incompatible;
}

void InputMonitor::check_losses(const InputEndpoints& endpoints, SteadyTime now, Lines& lines) {
  if (endpoints.samples_lost <= reported_lost_) return;
  if (reported_lost_at_ && now - *reported_lost_at_ < loss_report_period_ns) return;
  lines.push_back({[this, lost = endpoints.samples_lost - reported_lost_] {
    return fmt::format(
        "beacon {}: {} from ROS 2 lost: messages arrived on {} faster than they were processed",
        input_.address, lost_text(lost), input_.topic);
  }});
  reported_lost_ = endpoints.samples_lost;
  reported_lost_at_ = now;
}

void InputMonitor::log_unexpected_frame(std::string_view frame, Lines& lines) {
  if (unexpected_frames_.size() == max_unexpected_frames) return;
  if (std::find(unexpected_frames_.begin(), unexpected_frames_.end(), frame) != unexpected_frames_.end())
    return;
  unexpected_frames_.emplace_back(frame);
  lines.push_back({[this, found = std::string(frame), expected = *expected_frame_] {
    return input_.kind != Input::Kind::fix
               ? fmt::format(
                     "beacon {}: the frame of {} on {} has changed from '{}' to '{}': the same "
                     "axes are assumed",
                     input_.address, samples_text(), input_.topic, expected, found)
               : fmt::format("beacon {}: {} on {} are in frame '{}': they are used as if in '{}'",
                             input_.address, samples_text(), input_.topic, found, expected);
  }});
}

const char* InputMonitor::samples_text() const {
  return noun_of(input_.kind);
}

std::string InputMonitor::lost_text(std::uint64_t count) const {
  switch (input_.kind) {
    case Input::Kind::imu:
      return count_text(count, "IMU sample");
    case Input::Kind::fix:
      return count_text(count, "fix", "fixes");
    case Input::Kind::twist:
      return count_text(count, "velocity", "velocities");
    case Input::Kind::heading:
      return count_text(count, "heading");
    case Input::Kind::pose:
      return count_text(count, "pose");
  }
  return {};
}

void InputMonitor::on_notice(Notice notice, const std::function<std::string()>& detail, Lines& lines) {
  if (!noticed_.insert(notice).second) return;
  lines.push_back({[this, notice, text = detail ? detail() : std::string()] {
                     return fmt::format("beacon {}: {} {}", input_.address, input_.topic,
                                        text_of(notice, text));
                   },
                   notice == Notice::joined ? logging::Level::info : logging::Level::warning});
}

void InputMonitor::on_unused(const std::string& why, Lines& lines) {
  constexpr std::size_t max_reasons = 8;
  if (unused_.size() == max_reasons || !unused_.insert(why).second) return;
  lines.push_back({[this, why] {
    return fmt::format("beacon {}: {} has {} that are not used as they are: {}", input_.address, input_.topic,
                       samples_text(), why);
  }});
}

std::string InputMonitor::text_of(Notice notice, const std::string& detail) const {
  switch (notice) {
    case Notice::no_angular_velocity:
      return fmt::format(
          "has messages without an angular velocity ({}): they are joined with those of the gyroscope, or "
          "not "
          "used",
          detail);
    case Notice::no_specific_force:
      return fmt::format(
          "has messages without a linear acceleration ({}): they are joined with those of the accelerometer, "
          "or not used",
          detail);
    case Notice::joined:
      return "has the angular velocity of samples whose linear acceleration is interpolated to its times";
    case Notice::second_imu:
      return fmt::format("is not used: the samples of {} are complete", detail);
    case Notice::covariance:
      return fmt::format("has an unusable covariance, which counts as unknown: {}", detail);
    case Notice::clocks:
      return detail;
    case Notice::no_stamp:
      return "has messages without a stamp: they count as measured when they arrived; let the driver stamp "
             "them";
    case Notice::publishers:
      return "has several publishers at a time, whose measurements mix: stop all but one, or remap their "
             "topics";
    case Notice::repeats:
      return "repeats its last position: each one is used once";
  }
  return {};
}

std::string InputMonitor::cause(const InputEndpoints& endpoints, bool is_partial) const {
  if (endpoints.publishers > 0 && is_partial) {
    return fmt::format(
        "the messages on {} have only one of angular velocity and linear acceleration; if another "
        "topic has the other, give it as a second --imu-in",
        input_.topic);
  }
  if (endpoints.publishers > 0) {
    return fmt::format("{} has {}, but no valid message has arrived", input_.topic,
                       count_text(endpoints.publishers, "publisher"));
  }
  if (endpoints.publishers_incompatible > 0) {
    return fmt::format("the QoS of {} of {} does not match",
                       count_text(endpoints.publishers_incompatible, "publisher"), input_.topic);
  }
  switch (input_.kind) {
    case Input::Kind::imu:
      return fmt::format("there is no publisher of sensor_msgs/Imu on {}", input_.topic);
    case Input::Kind::fix:
      return fmt::format("there is no publisher of PointStamped or PoseWithCovarianceStamped on {}",
                         input_.topic);
    case Input::Kind::twist:
    case Input::Kind::heading:
    case Input::Kind::pose:
      return fmt::format("there is no publisher of its type on {}", input_.topic);
  }
  return {};
}

std::string clocks_text(double older_s, Input::Kind kind, const std::string& imu_topic) {
  constexpr double max_correction_s = 0.5;  // of the setting
  const bool is_old = older_s > 0;
  const bool has_setting = kind == Input::Kind::fix || kind == Input::Kind::pose;
  std::string text = fmt::format(
      "has stamps that are {:.3f} s {} than those of {}, each against its arrival{}: synchronise them",
      std::abs(older_s), is_old ? "older" : "newer", imu_topic,
      is_old ? fmt::format("; unless this is the latency of the {}, their clocks differ", noun_of(kind))
             : ", so their clocks differ");
  if (!has_setting || std::abs(older_s) > max_correction_s) return text;
  return text +
         fmt::format(", or set delay.correction_s = {:.3f}{}", -older_s, is_old ? " plus that latency" : "");
}

void SmallestOffset::add(double offset_s, SteadyTime now) {
  while (!rising_.empty() && rising_.back().second >= offset_s) rising_.pop_back();
  rising_.emplace_back(now, offset_s);
  while (now - rising_.front().first > loss_report_period_ns) rising_.pop_front();
}

}  // namespace sonopose::ros2
