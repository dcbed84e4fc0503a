#include "ros2/inputs/beacon_inputs.hpp"

#include <sonopose/ros2/messages/input.hpp>

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>

namespace sonopose::ros2 {
namespace {

using Notice = InputMonitor::Notice;

std::string text_of(const CovarianceFault& fault) {
  constexpr std::string_view axes = "xyz";
  return fmt::format("{:g} m² ({}, {}) is {}", fault.value_m2, axes[static_cast<std::size_t>(fault.row)],
                     axes[static_cast<std::size_t>(fault.column)], fault.reason);
}

std::optional<CovarianceFault> fault_of(const PointStamped& /*point*/) {
  return std::nullopt;
}
std::optional<CovarianceFault> fault_of(const PoseWithCovarianceStamped& pose) {
  return covariance_fault(pose);
}

}  // namespace

void BeaconInputs::add(const Input& input) {
  imus_ += input.kind == Input::Kind::imu ? 1 : 0;
}

bool BeaconInputs::on(const Imu& message, MonitoredInput& input, Moment moment, std::vector<ImuSample>& ready,
                      Lines& lines) {
  auto received = imu_sample(message, input.option.address, moment.received_ns);
  if (!received) return false;
  notice_stamp(message.header, input, lines);
  received->sample.meaning = input.option.imu_meaning;
  take(*received, message.header.frame_id, input, moment, ready, lines);
  return true;
}

bool BeaconInputs::on(const SensorCombined& message, MonitoredInput& input, Moment moment,
                      std::vector<ImuSample>& ready, Lines& lines) {
  auto received = imu_sample(message, input.option.address);
  if (received) take(*received, "", input, moment, ready, lines);
  return received.has_value();
}

void BeaconInputs::take(ReceivedImu& received, std::string_view frame, MonitoredInput& input, Moment moment,
                        std::vector<ImuSample>& ready, Lines& lines) {
  // A topic whose other values are all zero has one sensor only, even if it does not declare that.
  const bool is_unmarked = received.has_angular_velocity && received.has_specific_force;
  if (imus_ > 1 && is_unmarked) {
    received.has_specific_force = !received.sample.specific_force_body_mps2.isZero(0);
    received.has_angular_velocity = !received.sample.angular_velocity_body_radps.isZero(0);
  }
  const auto cause = [is_unmarked] { return is_unmarked ? "it is zero" : "its covariance[0] is -1"; };
  if (!received.has_angular_velocity) input.monitor.on_notice(Notice::no_angular_velocity, cause, lines);
  if (!received.has_specific_force) input.monitor.on_notice(Notice::no_specific_force, cause, lines);
  const bool is_complete = received.has_angular_velocity && received.has_specific_force;
  if (is_complete) notice_publisher(input, moment, lines);  // others may be of two sensors
  if (is_complete && complete_ == nullptr) complete_ = &input;
  if (complete_ != nullptr && complete_ != &input) {
    input.monitor.on_notice(
        Notice::second_imu, [&] { return complete_->option.topic; }, lines);
    return;
  }
  if (received.has_angular_velocity) gyroscope_ = &input;
  stamp_clock_.on_imu(received.sample.sensor_time_ns, moment.received_ns);
  offset_.add(seconds_between(received.sample.sensor_time_ns, moment.received_ns), moment.now);
  if (!imu_topic_) imu_topic_ = input.option.topic;
  const bool is_used = is_complete || joiner_.joined() > 0;
  if (is_used) input.monitor.on_sample(frame, moment.now, lines);
  joiner_.on(received, moment.now, ready);
  notice_joined(lines);
}

template <class Position>
BeaconInputs::TakenFix BeaconInputs::take(const Position& message, MonitoredInput& input, Moment moment,
                                          const InputFrames& frames, Lines& lines) {
  auto converted = fix(message, input.option.address, stamp_at(moment.received_ns));
  if (!converted) return {};
  std::string unused;
  const auto point_body_m = tag_in_body(input.option, frames, unused);
  if (!point_body_m) {
    input.monitor.on_unused(unused, lines);
    return {.unused = unused};
  }
  notice_stamp(message.header, input, lines);
  notice_publisher(input, moment, lines);
  converted->point_body_m = *point_body_m;
  note_stamp(converted->emission_time_ns, input, moment);
  if (imus_ == 0) offset_.add(seconds_between(converted->emission_time_ns, moment.received_ns), moment.now);
  input.monitor.on_sample(message.header.frame_id, moment.now, lines);
  if (const auto fault = fault_of(message)) {
    input.monitor.on_notice(
        Notice::covariance, [&fault] { return text_of(*fault); }, lines);
  }
  if (input.repeats.is_new(*converted)) return {.is_valid = true, .fix = converted};
  input.monitor.on_notice(Notice::repeats, {}, lines);
  return {.is_valid = true};
}

BeaconInputs::TakenFix BeaconInputs::on(const PointStamped& message, MonitoredInput& input, Moment moment,
                                        const InputFrames& frames, Lines& lines) {
  return take(message, input, moment, frames, lines);
}

BeaconInputs::TakenFix BeaconInputs::on(const PoseWithCovarianceStamped& message, MonitoredInput& input,
                                        Moment moment, const InputFrames& frames, Lines& lines) {
  return take(message, input, moment, frames, lines);
}

void BeaconInputs::note_stamp(TimeNs measured_ns, MonitoredInput& input, Moment moment) {
  input.offset.add(seconds_between(measured_ns, moment.received_ns), moment.now);
  if (!input.since) input.since = moment.now;
}

void BeaconInputs::check_clocks(MonitoredInput& input, SteadyTime now, Lines& lines) const {
  constexpr TimeNs settled_ns = 3'000'000'000;
  constexpr double max_apart_s = 0.05;
  if (!input.since || now - *input.since < settled_ns || !imu_topic_) return;
  const double apart_s = older_s(input);
  if (std::abs(apart_s) < max_apart_s) return;
  input.monitor.on_notice(
      Notice::clocks, [&] { return clocks_text(apart_s, input.option.kind, *imu_topic_); }, lines);
}

double BeaconInputs::older_s(const MonitoredInput& input) const {
  return input.offset.value_s() - offset_.value_s();
}

void BeaconInputs::update(SteadyTime now, std::vector<ImuSample>& ready, Lines& lines) {
  joiner_.update(now, ready);
  notice_joined(lines);
}

void BeaconInputs::notice_stamp(const Header& header, MonitoredInput& input, Lines& lines) {
  if (header.stamp.sec != 0 || header.stamp.nanosec != 0) return;
  ++input.unstamped;
  input.monitor.on_notice(Notice::no_stamp, {}, lines);
}

void BeaconInputs::notice_publisher(MonitoredInput& input, Moment moment, Lines& lines) {
  if (input.publishers.on(moment.publisher, moment.now))
    input.monitor.on_notice(Notice::publishers, {}, lines);
}

void BeaconInputs::notice_joined(Lines& lines) {
  if (joiner_.joined() == 0 || gyroscope_ == nullptr) return;
  gyroscope_->monitor.on_notice(Notice::joined, {}, lines);
}

}  // namespace sonopose::ros2
