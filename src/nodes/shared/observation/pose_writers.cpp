#include "observation/pose_writers.hpp"

#include "observation/beacon_observer.hpp"
#include <sonopose/dds/qos/match.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace sonopose::observation {
namespace {

std::int32_t strength_of(const PoseWriter& writer) {
  return writer.qos.policy_or_default<dds::policy::OwnershipStrength>().value();
}

/// True if one reader can receive both: partitions do not separate them on purpose.
bool share_readers(const PoseWriter& a, const PoseWriter& b) {
  const auto mismatches = dds::qos::mismatches(a.qos, b.qos);
  return std::none_of(mismatches.begin(), mismatches.end(),
                      [](const dds::qos::Mismatch& mismatch) { return mismatch.policy == "partition"; });
}

/// A beacon of both sets; empty if there is none.
std::optional<BeaconAddress> shared_beacon(const std::set<BeaconAddress>& a,
                                           const std::set<BeaconAddress>& b) {
  std::vector<BeaconAddress> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both.empty() ? std::nullopt : std::optional(both.front());
}

const PoseWriter* find(const std::vector<PoseWriter>& writers, dds::core::InstanceHandle handle) {
  const auto found = std::find_if(writers.begin(), writers.end(),
                                  [&](const PoseWriter& writer) { return writer.handle == handle; });
  return found == writers.end() ? nullptr : &*found;
}

/// Claims in the statuses of each participant.
class ClaimsOfParticipants {
public:
  ClaimsOfParticipants(const std::vector<dds::FoundEndpoint>& writers, const ServedBeacons& served) {
    for (const auto& endpoint : writers) {
      const auto* const claims = served.claims_of(endpoint.handle);
      if (claims != nullptr) claims_[endpoint.participant_key].insert(claims->begin(), claims->end());
    }
  }

  [[nodiscard]] const ServedBeacons::Claims& of(const PoseWriter& writer) const {
    static const ServedBeacons::Claims none;
    const auto found = claims_.find(writer.participant_key);
    return found == claims_.end() ? none : found->second;
  }

  /// True if no status of a beacon came although a fusion sends one a second.
  [[nodiscard]] bool is_unstated(BeaconAddress address, const PoseWriter& owner, TimeNs owned_ns) const {
    constexpr TimeNs grace_ns = 3'000'000'000;
    return owned_ns > grace_ns && !of(owner).contains(address);
  }

  /// True if the owner took a beacon over from a weaker fusion that still serves it, and had sent no status
  /// of it before. A fusion that stands by, or warms up, sends one a second.
  [[nodiscard]] bool is_seizure(BeaconAddress address, const PoseWriter& before, const PoseWriter& owner,
                                SteadyTime taken) const {
    constexpr TimeNs check_period_ns = 600'000'000;  // owners are checked every 0.5 s; with slack
    if (strength_of(before) >= strength_of(owner) || before.participant_key == owner.participant_key)
      return false;
    const auto own = of(owner).find(address);
    if (own != of(owner).end() && own->second.since + check_period_ns < taken) return false;
    const auto theirs = of(before).find(address);
    return theirs != of(before).end() && theirs->second.serves;
  }

private:
  std::map<std::string, ServedBeacons::Claims> claims_;
};

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
  return text::escaped(text);
}

void ServedBeacons::on_pose(BeaconAddress address, dds::core::InstanceHandle writer, SteadyTime now) {
  constexpr TimeNs discovery_ns = 3'000'000'000;
  const auto [found, is_new] = owners_.try_emplace(address, Owner{writer, now, std::nullopt});
  Owner& owner = found->second;
  if (is_new || owner.writer == writer) return;
  // Just after discovery another writer may only have been found first.
  const bool was_owner = now - owner.since > discovery_ns;
  owner = {writer, now, was_owner ? std::optional(owner.writer) : std::nullopt};
}

void ServedBeacons::on(const FusionStatus& status, dds::core::InstanceHandle writer, SteadyTime now) {
  if (claims_.size() >= max_writers && !claims_.contains(writer)) claims_.erase(claims_.begin());
  Claim& claim = claims_[writer].try_emplace(status.address, Claim{false, false, now}).first->second;
  claim.serves = serves(status);
  claim.is_sole = claim.serves && status.role == FusionRole::sole;
}

void ServedBeacons::forget(BeaconAddress address) {
  owners_.erase(address);
  for (auto& [writer, claims] : claims_) claims.erase(address);
  std::erase_if(claims_, [](const auto& entry) { return entry.second.empty(); });
}

const ServedBeacons::Claims* ServedBeacons::claims_of(dds::core::InstanceHandle writer) const {
  const auto found = claims_.find(writer);
  return found == claims_.end() ? nullptr : &found->second;
}

std::optional<dds::core::InstanceHandle> ServedBeacons::pose_writer_of(BeaconAddress address) const {
  const auto found = owners_.find(address);
  return found == owners_.end() ? std::nullopt : std::optional(found->second.writer);
}

std::vector<PoseWriter> pose_writers_of(const std::vector<dds::FoundEndpoint>& writers,
                                        const std::vector<dds::FoundParticipant>& participants,
                                        const ServedBeacons& served, SteadyTime now) {
  const ClaimsOfParticipants claims(writers, served);
  std::vector<PoseWriter> found;
  for (const auto& endpoint : writers) {
    if (endpoint.topic_name != dds::topics::pose.name) continue;
    PoseWriter writer{.participant_key = endpoint.participant_key, .process = {}, .qos = endpoint.qos};
    writer.handle = endpoint.handle;
    writer.has_status = std::any_of(writers.begin(), writers.end(), [&](const auto& sibling) {
      return sibling.participant_key == endpoint.participant_key &&
             sibling.topic_name == dds::topics::fusion_status.name;
    });
    for (const auto& [address, claim] : claims.of(writer)) {
      if (claim.serves) writer.served.insert(address);
      if (claim.is_sole) writer.sole.insert(address);
    }
    for (const auto& participant : participants) {
      if (participant.key != endpoint.participant_key) continue;
      writer.process = {participant.process_name, participant.host_name, participant.process_id,
                        participant.addresses};
    }
    found.push_back(std::move(writer));
  }
  for (const auto& [address, owner] : served.owners()) {
    const PoseWriter* const writer = find(found, owner.writer);
    if (writer == nullptr) continue;
    const auto* const victim = owner.before ? find(found, *owner.before) : nullptr;
    const bool is_seized = victim != nullptr && claims.is_seizure(address, *victim, *writer, owner.since);
    const bool is_unstated = claims.is_unstated(address, *writer, now - owner.since);
    for (PoseWriter& own : found) {
      if (own.participant_key != writer->participant_key) continue;
      own.served.insert(address);
      own.owned.insert(address);
      if (is_unstated) own.unstated.insert(address);
      if (is_seized) own.seized.emplace(address, victim->process);
    }
  }
  return found;
}

namespace {

/// Reason why a writer is no fusion; empty if it may be one.
std::string disqualification(const PoseWriter& writer) {
  if (!writer.has_status) return "is no fusion";
  if (!writer.unstated.empty()) {
    return fmt::format("sends no status of beacon {}, as a fusion would", *writer.unstated.begin());
  }
  if (strength_of(writer) > max_fusion_strength) {
    return fmt::format("is no fusion, whose strength is at most {}", max_fusion_strength);
  }
  if (writer.seized.empty()) return {};
  const auto& [address, victim] = *writer.seized.begin();
  return fmt::format("took beacon {} over from {}, which still serves it, without a status before", address,
                     text_of(victim));
}

constexpr const char* different_strengths = "use a different --standby-strength for each (docs/standby.md)";

/// Poses of a stronger process instead of those of a fusion that expects no other: a fusion that lacks
/// --standby-strength, or a process that imitates one. Empty if there is none.
std::optional<PoseWriterProblem> displacement(const PoseWriter& stronger, const PoseWriter& sole) {
  if (strength_of(stronger) <= strength_of(sole) || !disqualification(stronger).empty()) return std::nullopt;
  const auto beacon = shared_beacon(stronger.owned, sole.sole);
  if (!beacon) return std::nullopt;
  return PoseWriterProblem{
      false,
      fmt::format(
          "consumers receive the poses of beacon {} from {} with strength {}, not from {}, which is in "
          "no standby pair",
          *beacon, text_of(stronger.process), strength_of(stronger), text_of(sole.process)),
      fmt::format("stop the one that should not run, or {}", different_strengths)};
}

}  // namespace

std::vector<PoseWriterProblem> problems_of(const std::vector<PoseWriter>& writers) {
  std::vector<PoseWriterProblem> problems;
  const auto strongest = strongest_of_participants(writers);
  for (auto a = strongest.begin(); a != strongest.end(); ++a) {
    const std::string strength = std::to_string(strength_of(**a));
    if (const std::string reason = disqualification(**a); !reason.empty()) {
      const auto& addresses = (*a)->process.addresses;
      problems.push_back(
          {true,
           fmt::format(
               "{} writes poses with strength {} and {}; consumers receive its poses instead of those "
               "of weaker fusions{}",
               text_of((*a)->process), strength, reason,
               addresses.empty() ? "" : "; it announces the network addresses " + addresses),
           "stop it, or let it use another topic"});
    }
    for (auto b = std::next(a); b != strongest.end(); ++b) {
      if (!share_readers(**a, **b)) continue;
      if (auto problem = displacement(**a, **b)) problems.push_back(*std::move(problem));
      if (auto problem = displacement(**b, **a)) problems.push_back(*std::move(problem));
      if (strength_of(**a) == 0 || strength_of(**a) != strength_of(**b)) continue;
      const auto beacon = shared_beacon((*a)->served, (*b)->served);
      if (!beacon) continue;
      problems.push_back({false,
                          text_of((*a)->process) + " and " + text_of((*b)->process) +
                              " write poses of beacon " + std::to_string(*beacon) +
                              " with the same strength " + strength +
                              "; which one consumers receive is arbitrary",
                          different_strengths});
    }
  }
  return problems;
}

}  // namespace sonopose::observation
