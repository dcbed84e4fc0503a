#include "observation/pose_writers.hpp"

#include "observation/beacon_observer.hpp"
#include <sonopose/dds/qos/match.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <iterator>

namespace sonopose::observation {
namespace {

std::int32_t strength_of(const PoseWriter& writer) {
  const auto strength = writer.qos.policy<dds::policy::OwnershipStrength>();
  return strength ? strength->value : 0;
}

/// True if one reader can receive both: partitions do not separate them on purpose.
bool share_readers(const PoseWriter& a, const PoseWriter& b) {
  const auto mismatches = dds::qos::mismatches(a.qos, b.qos);
  return std::none_of(mismatches.begin(), mismatches.end(),
                      [](const dds::qos::Mismatch& mismatch) { return mismatch.policy == "partition"; });
}

/// A beacon that both serve; empty if there is none.
std::optional<BeaconAddress> shared_beacon(const PoseWriter& a, const PoseWriter& b) {
  std::vector<BeaconAddress> both;
  std::set_intersection(a.served.begin(), a.served.end(), b.served.begin(), b.served.end(),
                        std::back_inserter(both));
  return both.empty() ? std::nullopt : std::optional(both.front());
}

/// The strongest pose writer of each participant; a fusion's other writers have strength 0.
std::vector<const PoseWriter*> strongest_of_participants(const std::vector<PoseWriter>& writers) {
  std::map<std::string, const PoseWriter*> strongest;
  for (const PoseWriter& writer : writers) {
    const PoseWriter*& found = strongest[writer.participant_key];
    if (found == nullptr || strength_of(writer) > strength_of(*found)) found = &writer;
  }
  std::vector<const PoseWriter*> list;
  for (const auto& entry : strongest) list.push_back(entry.second);
  return list;
}

}  // namespace

std::string text_of(const ProcessIdentity& process) {
  if (process.name.empty() && process.host.empty() && !process.id) return "an unknown process";
  std::string text = process.name.empty() ? "a process" : process.name;
  if (process.id) text += " (process " + std::to_string(*process.id);
  if (!process.host.empty()) text += (process.id ? " on " : " (on ") + process.host;
  if (process.id || !process.host.empty()) text += ")";
  return text;
}

void ServedBeacons::on(const FusionStatus& status, dds::InstanceHandle writer) {
  if (serves(status)) {
    statuses_[writer].insert(status.address);
  } else {
    statuses_[writer].erase(status.address);
  }
}

void ServedBeacons::forget(BeaconAddress address) {
  owners_.erase(address);
  for (auto& [writer, beacons] : statuses_) beacons.erase(address);
  std::erase_if(statuses_, [](const auto& entry) { return entry.second.empty(); });
}

std::set<BeaconAddress> ServedBeacons::of(dds::InstanceHandle writer) const {
  const auto found = statuses_.find(writer);
  std::set<BeaconAddress> beacons = found == statuses_.end() ? std::set<BeaconAddress>{} : found->second;
  for (const auto& [address, owner] : owners_) {
    if (owner == writer) beacons.insert(address);
  }
  return beacons;
}

std::optional<dds::InstanceHandle> ServedBeacons::pose_writer_of(BeaconAddress address) const {
  const auto found = owners_.find(address);
  return found == owners_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<PoseWriter> pose_writers_of(const std::vector<dds::FoundEndpoint>& writers,
                                        const std::vector<dds::FoundParticipant>& participants,
                                        const ServedBeacons& served) {
  std::vector<PoseWriter> found;
  for (const auto& endpoint : writers) {
    if (endpoint.topic_name != dds::topics::pose.name) continue;
    PoseWriter writer{
        .participant_key = endpoint.participant_key, .process = {}, .qos = endpoint.qos, .served = {}};
    for (const auto& sibling : writers) {
      if (sibling.participant_key != endpoint.participant_key) continue;
      writer.has_status = writer.has_status || sibling.topic_name == dds::topics::fusion_status.name;
      writer.served.merge(served.of(sibling.handle));
    }
    for (const auto& participant : participants) {
      if (participant.key != endpoint.participant_key) continue;
      writer.process = {participant.process_name, participant.host_name, participant.process_id};
    }
    found.push_back(std::move(writer));
  }
  return found;
}

std::vector<PoseWriterProblem> problems_of(const std::vector<PoseWriter>& writers) {
  std::vector<PoseWriterProblem> problems;
  const auto strongest = strongest_of_participants(writers);
  for (auto a = strongest.begin(); a != strongest.end(); ++a) {
    const std::string strength = std::to_string(strength_of(**a));
    if (!(*a)->has_status) {
      problems.push_back(
          {true,
           text_of((*a)->process) + " writes poses with strength " + strength +
               " and is no fusion; consumers receive its poses instead of those of weaker fusions",
           "stop it, or let it use another topic"});
    }
    for (auto b = std::next(a); b != strongest.end(); ++b) {
      if (strength_of(**a) == 0 || strength_of(**a) != strength_of(**b) || !share_readers(**a, **b)) continue;
      const auto beacon = shared_beacon(**a, **b);
      if (!beacon) continue;
      problems.push_back({false,
                          text_of((*a)->process) + " and " + text_of((*b)->process) +
                              " write poses of beacon " + std::to_string(*beacon) +
                              " with the same strength " + strength +
                              "; which one consumers receive is arbitrary",
                          "use a different --standby-strength for each (docs/standby.md)"});
    }
  }
  return problems;
}

}  // namespace sonopose::observation
