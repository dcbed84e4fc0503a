#include "ros2/relay/input_detector.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::ros2 {
namespace {

constexpr TimeNs loss_report_period_ns = 1'000'000'000;
/// A sender that makes up a new frame for each message shall not be told of for ever.
constexpr std::size_t most_foreign_frames = 8;

bool is_imu(const Ros2Input& input) {
  return input.kind == Ros2Input::Kind::imu;
}

/// tf2 took frames with a slash in front once; they are the same.
std::string_view without_slash(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return frame;
}

}  // namespace

Ros2InputDetector::Ros2InputDetector(Ros2Input input, std::string map_frame, TimeNs timeout_ns,
                                     SteadyTime now)
    : input_(std::move(input)), timeout_ns_(timeout_ns), latest_(now) {
  if (!is_imu(input_)) expected_frame_ = std::move(map_frame);
}

void Ros2InputDetector::on_sample(std::string_view frame, SteadyTime now, Lines& lines) {
  heard_ = true;
  latest_ = now;
  frame = without_slash(frame);
  if (!expected_frame_) expected_frame_ = frame;
  if (frame != *expected_frame_) log_foreign_frame(frame, lines);
}

void Ros2InputDetector::look(const Ros2InputEnds& ends, SteadyTime now, Lines& lines) {
  look_for_silence(ends, now, lines);
  look_for_losses(ends, now, lines);
}

void Ros2InputDetector::look_for_silence(const Ros2InputEnds& ends, SteadyTime now, Lines& lines) {
  const bool was_silent = silence_.has_value();
  if (now - latest_ > (heard_ ? timeout_ns_ : std::max(timeout_ns_, first_sample_ns))) {
    if (!was_silent) silence_ = Silence{latest_, !heard_};
    // Somebody who came later and does not match is the likely cause.
    const bool has_news = ends.publishers == 0 && ends.publishers_refused > reported_refused_;
    if (!was_silent || has_news) log_silence(ends, now, lines);
  } else if (was_silent) {
    lines.push_back(fmt::format("beacon {}: {} from ROS 2{}, after {:.1f} s", input_.address, what(),
                                silence_->is_first ? "" : " again",
                                seconds_between(silence_->since, latest_)));
    silence_.reset();
  }
}

void Ros2InputDetector::log_silence(const Ros2InputEnds& ends, SteadyTime now, Lines& lines) {
  const std::string lasted =
      silence_->is_first ? "yet" : fmt::format("for {:.1f} s", seconds_between(silence_->since, now));
  lines.push_back(
      fmt::format("beacon {}: no {} from ROS 2 {}: {}", input_.address, what(), lasted, reason(ends)));
  reported_refused_ = ends.publishers_refused;
}

void Ros2InputDetector::look_for_losses(const Ros2InputEnds& ends, SteadyTime now, Lines& lines) {
  if (ends.samples_lost <= reported_lost_) return;
  if (reported_lost_at_ && now - *reported_lost_at_ < loss_report_period_ns) return;
  lines.push_back(fmt::format("beacon {}: {} {} from ROS 2 lost: they came on {} faster than they were taken",
                              input_.address, ends.samples_lost - reported_lost_, what(), input_.topic));
  reported_lost_ = ends.samples_lost;
  reported_lost_at_ = now;
}

void Ros2InputDetector::log_foreign_frame(std::string_view frame, Lines& lines) {
  if (foreign_frames_.size() == most_foreign_frames) return;
  if (std::find(foreign_frames_.begin(), foreign_frames_.end(), frame) != foreign_frames_.end()) return;
  foreign_frames_.emplace_back(frame);
  lines.push_back(
      is_imu(input_)
          ? fmt::format("beacon {}: {} on {} are in frame '{}' now, in '{}' before: they are taken "
                        "as of the same axes",
                        input_.address, what(), input_.topic, frame, *expected_frame_)
          : fmt::format("beacon {}: {} on {} are in frame '{}': they are taken as in '{}'", input_.address,
                        what(), input_.topic, frame, *expected_frame_));
}

const char* Ros2InputDetector::what() const {
  return is_imu(input_) ? "IMU samples" : "fixes";
}

std::string Ros2InputDetector::reason(const Ros2InputEnds& ends) const {
  if (ends.publishers > 0) {
    return fmt::format("{} has {} publisher{}, but nothing usable comes", input_.topic, ends.publishers,
                       ends.publishers == 1 ? "" : "s");
  }
  if (ends.publishers_refused > 0) {
    return fmt::format("the QoS of {} publisher{} of {} does not match", ends.publishers_refused,
                       ends.publishers_refused == 1 ? "" : "s", input_.topic);
  }
  return fmt::format("nobody publishes {} on {}",
                     is_imu(input_) ? "sensor_msgs/Imu" : "PointStamped or PoseWithCovarianceStamped",
                     input_.topic);
}

void SmallestOffset::add(double offset_s, SteadyTime now) {
  while (!rising_.empty() && rising_.back().second >= offset_s) rising_.pop_back();
  rising_.emplace_back(now, offset_s);
  while (now - rising_.front().first > loss_report_period_ns) rising_.pop_front();
}

}  // namespace sonopose::ros2
