#include "bus_log/latched_start.hpp"

#include "bus_log/instance_end.hpp"
#include "bus_log/latched_samples.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

namespace sonopose::bus_log {

namespace {

/// Returns true if the QoS that a recorder of ROS 2 has noted, as YAML, is that of a latched topic. Others do
/// not note it, but static transforms are always latched.
bool is_latched_in_ros(const mcap::Channel& channel) {
  if (channel.topic.ends_with("/tf_static")) return true;
  constexpr std::array<std::string_view, 2> latched{"durability: 1\n", "durability: transient_local\n"};
  const auto found = channel.metadata.find("offered_qos_profiles");
  if (found == channel.metadata.end()) return false;
  const std::string offered = found->second + "\n";
  return std::ranges::any_of(
      latched, [&](std::string_view words) { return offered.find(words) != std::string::npos; });
}

}  // namespace

LatchedStart latched_start(const mcap::Reader& reader, const mcap::Selection& selection,
                           const dds::qos::Provider& qos, const std::function<bool()>& is_stopped) {
  const mcap::TimeSpan& times = reader.statistics().log_times;
  if (selection.start_ns <= times.start_ns || selection.start_ns > times.end_ns) return {};
  std::map<std::uint16_t, const dds::topics::SerializedTopic*> native;
  std::set<std::uint16_t> others;
  std::optional<std::uint16_t> ends_channel_id;  // any number may be that of another topic
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.topic == instance_ends_topic) ends_channel_id = id;
    if (selection.channel && !selection.channel(channel)) continue;
    const auto* const topic = dds::topics::find_topic(channel.topic);
    const bool is_native = topic != nullptr && channel.topic == topic->name;
    if (is_native && topic->is_latched(qos)) native[id] = topic;
    if (!is_native && is_latched_in_ros(channel)) others.insert(id);
  }
  LatchedSamples latched(native, ends_channel_id);
  for (const std::uint16_t id : others) latched.add_plain(id);
  mcap::Selection before;
  before.channel = [&](const mcap::Channel& channel) {
    return channel.id == ends_channel_id || native.contains(channel.id) || others.contains(channel.id);
  };
  before.end_ns = selection.start_ns - 1;
  before.order = mcap::Selection::Order::file;
  before.damaged = mcap::Selection::Damaged::skip;
  mcap::Messages messages(reader, before);
  while (const auto message = messages.next()) {
    if (is_stopped && is_stopped()) return {};
    try {
      latched.on(*message);
    } catch (const std::invalid_argument&) {  // NOLINT(bugprone-empty-catch): not the end of an instance
    }
  }
  return {latched.chunk_at(selection.start_ns), messages.skipped()};
}

}  // namespace sonopose::bus_log
