#pragma once
/// \file
/// Simulated drives as the messages of ROS 2 drivers, and recordings of rosbag2 made without ROS.

#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "sim/simulator.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/serialized_types.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sonopose::test {

/// A serialized message of a topic, as the recorder of ROS 2 receives it.
struct RosMessage {
  std::string topic;
  std::string type;
  TimeNs received_ns = 0;
  std::vector<std::byte> data;
};

template <class T>
RosMessage message_of(const std::string& topic, const T& sample, TimeNs received_ns,
                      std::endian byte_order = std::endian::little) {
  return {topic, ros2::type_name_in_ros(dds::TopicTraits<T>::descriptor().m_typename), received_ns,
          dds::write_cdr(sample, byte_order)};
}

inline RosMessage imu_message(const ImuSample& sample, const std::string& topic = "/imu/data",
                              std::endian byte_order = std::endian::little) {
  return message_of(topic, ros2::raw_imu(sample, sample.sensor_time_ns, {}, {}), sample.sensor_time_ns,
                    byte_order);
}

inline RosMessage fix_message(const UltrasonicFix& fix, const std::string& topic = "/tag/point",
                              std::endian byte_order = std::endian::little) {
  return message_of(topic, ros2::position_as_point(fix.position_world_m, fix.emission_time_ns, {}),
                    fix.received_time_ns, byte_order);
}

/// IMU samples and fixes of the scenario "walk", as a bag should give them back.
inline std::vector<Event> walk_events(double duration_s) {
  std::vector<Event> events;
  for (Event& event : sim::record(sim::find_scenario("walk"), {.duration_s = duration_s}).events) {
    if (auto* const imu = std::get_if<ImuSample>(&event)) {
      imu->meaning = ImuMeaning::unknown;
      imu->magnetic_field_body_t.reset();
      imu->bridge_time_ns = 0;
    } else if (auto* const fix = std::get_if<UltrasonicFix>(&event)) {
      fix->flags = 0;
      fix->quality_percent.reset();
      fix->covariance_world_m2.reset();
      fix->measured_delay_s = seconds_between(fix->emission_time_ns, fix->received_time_ns);
    } else {
      continue;
    }
    std::visit(
        [&events](auto& sample) {
          sample.address = 7;
          sample.sequence = events.size() + 1;
        },
        event);
    events.push_back(std::move(event));
  }
  return events;
}

/// Describes the first event that differs; empty if there is none.
inline std::string difference(const std::vector<Event>& events, const std::vector<Event>& expected) {
  const auto [found, wanted] = std::ranges::mismatch(events, expected);
  if (found == events.end() && wanted == expected.end()) return {};
  if (found == events.end() || wanted == expected.end()) {
    return std::to_string(events.size()) + " events instead of " + std::to_string(expected.size());
  }
  std::string text = "event " + std::to_string(found - events.begin()) + " of kind " +
                     std::to_string(found->index()) + " at " + std::to_string(available_at_ns(*found));
  return text + " instead of kind " + std::to_string(wanted->index()) + " at " +
         std::to_string(available_at_ns(*wanted));
}

inline std::vector<RosMessage> messages_of(const std::vector<Event>& events,
                                           std::endian byte_order = std::endian::little) {
  std::vector<RosMessage> messages;
  for (const Event& event : events) {
    const auto* const imu = std::get_if<ImuSample>(&event);
    messages.push_back(imu != nullptr
                           ? imu_message(*imu, "/imu/data", byte_order)
                           : fix_message(std::get<UltrasonicFix>(event), "/tag/point", byte_order));
  }
  return messages;
}

/// Differences between the recorders of the distributions.
struct BagLayout {
  std::string message_encoding = "cdr";
  std::string schema_encoding = "ros2msg";
  bool has_definitions = true;
  bool has_type_hashes = false;
};

inline void write_bag(const std::filesystem::path& file, const std::vector<RosMessage>& messages,
                      const BagLayout& layout = {}) {
  mcap::FileSink sink(file);
  mcap::Writer writer(sink, {.profile = "ros2", .library = "libmcap 1.1.0", .chunk_size_bytes = 16384});
  std::map<std::string, std::uint16_t> channels;
  for (const RosMessage& message : messages) {
    if (!channels.contains(message.topic)) {
      std::string dds_name = message.type;
      for (std::size_t at = 0; (at = dds_name.find('/', at)) != std::string::npos;)
        dds_name.replace(at, 1, "::");
      dds_name.insert(dds_name.rfind("::") + 2, "dds_::");
      const auto schema = writer.add_schema(
          message.type, layout.schema_encoding,
          layout.has_definitions ? ros2::message_definition(dds_name + "_") : std::string_view());
      mcap::TextMap metadata{{"offered_qos_profiles", ""}};
      if (layout.has_type_hashes) metadata["topic_type_hash"] = "RIHS01_0";
      channels[message.topic] = writer.add_channel(schema, message.topic, layout.message_encoding, metadata);
    }
    const auto time_ns = static_cast<std::uint64_t>(message.received_ns);
    writer.write({channels[message.topic], 0, time_ns, time_ns, message.data});
  }
  writer.close();
}

}  // namespace sonopose::test
