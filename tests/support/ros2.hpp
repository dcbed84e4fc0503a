#pragma once
/// \file
/// The other side of the relay: a ROS 2 process's readers and writers, as rclcpp makes them.

#include "support/bus.hpp"
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <string>

namespace sonopose::test {

/// Best effort, keep-last 5, as sensors' subscriptions are; reliable as the default, though with more room
/// than its ten, for a test that is held up; or as for what stays.
enum class Subscription : std::uint8_t { standard, sensor_data, latched };

inline dds::Qos qos_of(Subscription kind) {
  using namespace dds::policy;
  dds::Qos qos;
  switch (kind) {
    case Subscription::standard:
      return qos << Reliability::reliable() << History::keep_last(100);
    case Subscription::sensor_data:
      return qos << Reliability::best_effort() << History::keep_last(5);
    case Subscription::latched:
      return qos << Reliability::reliable() << Durability{DurabilityKind::transient_local}
                 << History::keep_last(1);
  }
  return qos;
}

/// A process's subscription, with a participant of its own. Its calls see one message after the other.
template <class T>
class RosReader {
public:
  RosReader(const Bus& bus, const std::string& topic, Subscription kind = Subscription::standard)
      : participant_(dds::make_participant({.domain_id = bus.domain_id()})),
        reader_(participant_, dds::Topic<T>(participant_, ros2::name_in_dds(topic)), qos_of(kind)) {}

  /// Waits until `look(const T&)` has said true of one.
  template <class Look>
  bool wait_for(const Look& look, std::chrono::milliseconds timeout = timeout) {
    bool found = false;
    return wait_for_status(
        reader_, dds::StatusMask::data_available(),
        [&] {
          reader_.take_each(
              [&](const T& message, const dds::SampleInfo&) { found = look(message) || found; });
          return found;
        },
        timeout);
  }

  /// Waits for `count` messages and calls `look(const T&)` of each.
  template <class Look>
  bool wait_for_count(std::size_t count, const Look& look, std::chrono::milliseconds timeout = timeout) {
    return wait_for(
        [&](const T& message) {
          look(message);
          return ++seen_ >= count;
        },
        timeout);
  }

  /// Whether anybody writes the topic.
  bool wait_for_writer() {
    return wait_for_status(reader_, dds::StatusMask::subscription_matched(),
                           [&] { return reader_.subscription_matched_status().current_count > 0; });
  }

private:
  dds::DomainParticipant participant_;
  dds::DataReader<T> reader_;
  std::size_t seen_ = 0;
};

/// A driver's publisher. Drivers offer no deadline and shared ownership: the defaults of DDS.
template <class T>
class RosWriter {
public:
  RosWriter(const Bus& bus, const std::string& topic, bool reliable = true)
      : participant_(dds::make_participant({.domain_id = bus.domain_id()})),
        writer_(participant_, dds::Topic<T>(participant_, ros2::name_in_dds(topic)),
                qos_of(reliable ? Subscription::standard : Subscription::sensor_data)) {}

  bool wait_for_reader() {
    return wait_for_status(writer_, dds::StatusMask::publication_matched(),
                           [&] { return writer_.publication_matched_status().current_count > 0; });
  }
  void write(const T& message) { writer_.write(message); }

private:
  dds::DomainParticipant participant_;
  dds::DataWriter<T> writer_;
};

inline TimeNs stamp_of(const ros2::Header& header) {
  return ros2::from_ros(header.stamp).value_or(-1);
}

}  // namespace sonopose::test
