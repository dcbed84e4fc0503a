#include <sonopose/ros2/node/graph.hpp>

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::ros2 {
namespace {

/// Age at which a participant is judged; its endpoints follow it within milliseconds.
constexpr TimeNs judged_after_ns = 2'000'000'000;

/// Vendor id, the first two bytes of a GUID, except for vendors that do not follow RTPS 2.2.
constexpr std::string_view fast_dds_vendor = "010f";

bool contains(const std::vector<std::uint8_t>& bytes, std::string_view text) {
  return std::search(bytes.begin(), bytes.end(), text.begin(), text.end()) != bytes.end();
}

bool has_type_hash(const dds::FoundEndpoint& endpoint) {
  const auto user_data = endpoint.qos.policy<dds::policy::UserData>();
  return user_data && contains(user_data->value(), "typehash=");
}

}  // namespace

std::optional<Distro> layout_for(const Graph& graph) {
  if (graph.has_humble) return Distro::humble;
  if (graph.has_jazzy) return Distro::jazzy;
  return std::nullopt;
}

GraphObserver::GraphObserver(const dds::domain::DomainParticipant& participant,
                             std::function<void()> on_change)
    : discovery_(participant, std::move(on_change)) {}

void GraphObserver::Process::add(const dds::FoundEndpoint& endpoint) {
  const bool has_hash = has_type_hash(endpoint);
  any_has_hash = any_has_hash || has_hash;
  if (endpoint.topic_name == discovery_topic) discovery_has_hash = has_hash;
}

Graph GraphObserver::observe(SteadyTime now) {
  Graph graph;
  std::set<std::string> members;
  const std::string own = discovery_.own_key();
  for (const dds::FoundParticipant& each : discovery_.participants()) {
    graph.has_fast_dds = graph.has_fast_dds || each.key.starts_with(fast_dds_vendor);
    if (each.key != own && contains(each.user_data, "enclave=")) members.insert(each.key);
  }
  std::erase_if(processes_, [&](const auto& known) { return !members.contains(known.first); });
  for (const std::string& key : members) processes_.try_emplace(key, Process{.first_seen = now});
  for (const auto& endpoints : {discovery_.writers(), discovery_.readers()}) {
    for (const dds::FoundEndpoint& endpoint : endpoints) {
      if (const auto process = processes_.find(endpoint.participant_key); process != processes_.end()) {
        process->second.add(endpoint);
      }
    }
  }
  for (const auto& [key, process] : processes_) {
    const bool is_old = now - process.first_seen >= judged_after_ns;
    // A relay that has found no other process has Humble's layout, but type hashes on its topics.
    const bool has_hash = process.discovery_has_hash.value_or(process.any_has_hash);
    const bool is_relay = !has_hash && process.any_has_hash;
    if (is_relay) continue;
    if (!process.discovery_has_hash && !is_old) {
      graph.is_undecided = true;
    } else if (has_hash) {
      graph.has_jazzy = true;
    } else {
      graph.has_humble = true;
    }
  }
  return graph;
}

}  // namespace sonopose::ros2
