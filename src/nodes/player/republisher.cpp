#include "player/republisher.hpp"

#include "bus_log/instance_end.hpp"
#include "mcap/omg_idl.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/idl/text.hpp>

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace sonopose::player {

namespace topics = dds::topics;

std::string obstacle_to(const mcap::Channel& channel, const mcap::Schema* schema) {
  if (channel.topic == bus_log::instance_ends_topic) return {};
  const auto* const topic = topics::find_topic(channel.topic);
  if (topic == nullptr || channel.topic != topic->name) return "it is not a topic of this program";
  if (channel.message_encoding != "cdr") return "its messages are not cdr but " + channel.message_encoding;
  if (schema == nullptr || schema->name != topic->type_name) {
    return "its type is not " + std::string(topic->type_name) + " but " +
           (schema == nullptr ? "unknown" : schema->name);
  }
  if (!schema->data.empty() &&
      mcap::definition_in(schema->data, schema->name) != mcap::definition_in(idl::text, schema->name)) {
    return "its type " + schema->name + " differs from the one of this version of the program";
  }
  return {};
}

Republisher::Republisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                         const std::vector<std::string>& names, topics::Delivery delivery) {
  std::string refused;
  for (const std::string& name : names) {
    const auto* const topic = topics::find_topic(name);
    if (topic == nullptr) continue;
    try {
      streams_.try_emplace(topic->name, Stream{topic, topic->make_writer(participant, qos, delivery)});
    } catch (const dds::ForbiddenError&) {
      refused += (refused.empty() ? "" : ", ") + std::string(topic->name);
    }
  }
  if (!refused.empty()) {
    throw std::invalid_argument("the enclave may not write " + refused +
                                "; choose others with --topics, or an enclave that may with --enclave");
  }
}

TimeNs Republisher::shifted(std::uint64_t time_ns) const {
  constexpr auto greatest = static_cast<std::uint64_t>(std::numeric_limits<TimeNs>::max());
  return std::max<TimeNs>(saturated_sum(static_cast<TimeNs>(std::min(time_ns, greatest)), shift_ns_), 0);
}

Republisher::Outcome Republisher::publish(const std::string& topic, const mcap::Message& message,
                                          const process::StopSignal& stop) {
  if (topic == bus_log::instance_ends_topic) return end_instance(message, stop);
  const auto found = streams_.find(topic);
  if (found == streams_.end()) return Outcome::refused;
  auto bytes = message.data;
  if (shift_ns_ != 0) {
    moved_.assign(bytes.begin(), bytes.end());
    if (!found->second.topic->shift_times(moved_, shift_ns_)) return Outcome::refused;
    bytes = moved_;
  }
  return forward(found->second, bytes, shifted(message.publish_time_ns), dds::ext::Change::write, stop);
}

Republisher::Outcome Republisher::end_instance(const mcap::Message& message,
                                               const process::StopSignal& stop) {
  const std::string_view text(
      reinterpret_cast<const char*>(message.data.data()),  // NOLINT(*-reinterpret-cast)
      message.data.size());
  bus_log::InstanceEnd end;
  try {
    end = bus_log::instance_end_of(text);
  } catch (const std::invalid_argument&) {
    return Outcome::refused;
  }
  const auto found = streams_.find(end.topic);
  if (found == streams_.end()) return Outcome::unplayed;
  const auto change = end.disposed ? dds::ext::Change::dispose : dds::ext::Change::unregister;
  return forward(found->second, end.key_cdr, shifted(message.publish_time_ns), change, stop);
}

Republisher::Outcome Republisher::forward(Stream& stream, std::span<const std::byte> bytes, TimeNs stamp_ns,
                                          dds::ext::Change change, const process::StopSignal& stop) {
  const dds::ReturnCode code =
      dds::ext::retry_unless([&stop] { return stop.requested(); },
                             [&] { return dds::ext::try_forward(stream.writer, bytes, stamp_ns, change); });
  return code >= 0 ? Outcome::published : Outcome::refused;
}

Republisher::Readers Republisher::readers() {
  Readers readers{.all = 0, .min = std::numeric_limits<std::size_t>::max()};
  for (auto& [name, stream] : streams_) {
    const auto count = static_cast<std::size_t>(stream.writer.publication_matched_status().current_count());
    readers.all += count;
    readers.min = std::min(readers.min, count);
  }
  return readers;
}

std::vector<std::string> Republisher::wait_until_read(const process::StopSignal& stop) {
  constexpr std::chrono::milliseconds step{100};
  constexpr int max_steps = 100;
  std::vector<std::string> unread;
  for (auto& [name, stream] : streams_) {
    int steps = 0;
    while (steps < max_steps && !stop.requested() && !dds::ext::wait_for_acknowledgments(stream.writer, step))
      ++steps;
    if (steps == max_steps) unread.push_back(name);
  }
  return unread;
}

}  // namespace sonopose::player
