#pragma once
/// \file
/// Readers and writers of a ROS 2 process, as created by rclcpp.

#include "support/bus.hpp"
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <string>

namespace sonopose::test {

/// QoS of a subscription. `sensor_data`: best effort, keep-last 5. `standard`: reliable, with a deeper
/// history than the default for a delayed test. `latched`, `latched_log`: transient local with one message or
/// many.
enum class Subscription : std::uint8_t { standard, sensor_data, latched, latched_log };

inline dds::Qos qos_of(Subscription kind) {
  using namespace dds::policy;
  dds::Qos qos;
  switch (kind) {
    case Subscription::standard:
      return qos << Reliability::Reliable() << History::KeepLast(100);
    case Subscription::sensor_data:
      return qos << Reliability::BestEffort() << History::KeepLast(5);
    case Subscription::latched:
    case Subscription::latched_log:
      return qos << Reliability::Reliable() << Durability{DurabilityKind::TRANSIENT_LOCAL}
                 << History::KeepLast(kind == Subscription::latched ? 1 : 1000);
  }
  return qos;
}

/// A subscription with its own participant. Its calls consume the messages in sequence.
template <class T>
class RosReader {
public:
  RosReader(const Bus& bus, const std::string& topic, Subscription kind = Subscription::standard)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        reader_(dds::sub::Subscriber(participant_),
                dds::topic::Topic<T>(participant_, ros2::name_in_dds(topic), dds::Qos()), qos_of(kind)) {}

  /// Waits until `inspect(const T&)` returns true for a message.
  template <class Look>
  bool wait_for(const Look& inspect, std::chrono::milliseconds limit = timeout) {
    bool found = false;
    return wait_for_status(
        reader_, dds::core::status::StatusMask::data_available(),
        [&] {
          dds::ext::take_each(reader_, [&](const T& message, const dds::sub::SampleInfo&) {
            found = inspect(message) || found;
          });
          return found;
        },
        limit);
  }

  /// Waits for `count` messages and calls `inspect(const T&)` for each.
  template <class Look>
  bool wait_for_count(std::size_t count, const Look& inspect, std::chrono::milliseconds limit = timeout) {
    return wait_for(
        [&](const T& message) {
          inspect(message);
          return ++seen_ >= count;
        },
        limit);
  }

  /// Calls `inspect(const T&)` for each available message.
  template <class Look>
  void take(const Look& inspect) {
    dds::ext::take_each(reader_, [&](const T& message, const dds::sub::SampleInfo&) { inspect(message); });
  }

  /// Waits until the topic has a writer.
  bool wait_for_writer() {
    return wait_for_status(reader_, dds::core::status::StatusMask::subscription_matched(),
                           [&] { return reader_.subscription_matched_status().current_count() > 0; });
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::sub::DataReader<T> reader_;
  std::size_t seen_ = 0;
};

/// Publisher of a driver, with the DDS defaults: no deadline offered, shared ownership.
template <class T>
class RosWriter {
public:
  RosWriter(const Bus& bus, const std::string& topic, bool reliable = true)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        writer_(dds::pub::Publisher(participant_),
                dds::topic::Topic<T>(participant_, ros2::name_in_dds(topic), dds::Qos()),
                qos_of(reliable ? Subscription::standard : Subscription::sensor_data)) {}

  bool wait_for_reader() {
    return wait_for_status(writer_, dds::core::status::StatusMask::publication_matched(),
                           [&] { return writer_.publication_matched_status().current_count() > 0; });
  }
  void write(const T& message) { writer_.write(message); }

private:
  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<T> writer_;
};

inline TimeNs stamp_of(const ros2::Header& header) {
  return ros2::from_ros(header.stamp).value_or(-1);
}

}  // namespace sonopose::test
