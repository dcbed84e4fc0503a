#include "publication/lossy_fusions.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "observation/pose_writers.hpp"
#include <sonopose/dds/qos/match.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::publication {
namespace {

namespace topics = dds::topics;

constexpr TimeNs status_poll_ns = 20'000'000;

bool keeps_all(const dds::Qos& qos) {
  return qos.policy_or_default<dds::policy::History>().kind() == dds::policy::HistoryKind::KEEP_ALL;
}

std::string name_of(const std::string& participant_key,
                    const std::vector<dds::FoundParticipant>& participants) {
  const auto found = std::find_if(participants.begin(), participants.end(),
                                  [&](const auto& each) { return each.key == participant_key; });
  if (found == participants.end()) return text_of(observation::ProcessIdentity{});
  return text_of(observation::ProcessIdentity{found->process_name, found->host_name, found->process_id});
}

}  // namespace

LossyFusions::LossyFusions(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos)
    : participant_(participant), qos_(qos), discovery_(participant) {}

/// Adds those that have appeared, and logs them. Returns true if a reader may be another one, whose writers
/// are not discovered yet.
bool LossyFusions::find() {
  const auto writers = discovery_.writers();
  const auto writer_of = [&writers](const std::string& participant_key, const char* topic) {
    const auto found = std::find_if(writers.begin(), writers.end(), [&](const auto& writer) {
      return writer.participant_key == participant_key && writer.topic_name == topic;
    });
    return found == writers.end() ? nullptr : &*found;
  };
  const dds::FoundEndpoint* const own = writer_of(discovery_.own_key(), topics::imu.name);
  if (own == nullptr) return false;
  bool is_uncertain = false;
  for (const dds::FoundEndpoint& reader : discovery_.readers()) {
    if (reader.topic_name != topics::imu.name || keeps_all(reader.qos)) continue;
    if (!dds::qos::mismatches(own->qos, reader.qos).empty()) continue;
    const auto* const status = writer_of(reader.participant_key, topics::fusion_status.name);
    if (status == nullptr || writer_of(reader.participant_key, topics::pose.name) == nullptr) {
      is_uncertain = true;
      continue;
    }
    const auto [found, is_new] = fusions_.try_emplace(reader.participant_key);
    Fusion& fusion = found->second;
    if (!is_new) continue;
    fusion.status_writer = status->handle;
    fusion.name = name_of(reader.participant_key, discovery_.participants());
    logging::warning(
        fmt::format("{} may lose events at --rate 0: it has been started without --lossless", fusion.name));
  }
  return is_uncertain;
}

/// Takes statuses. `has_begun`: a new one counts all its losses.
void LossyFusions::take(bool has_begun) {
  const SteadyTime now = clocks::steady_now();
  dds::ext::take_each(*statuses_, [&](const sonopose_FusionStatus& status, const dds::sub::SampleInfo& info) {
    for (auto& [key, fusion] : fusions_) {
      if (fusion.status_writer != info.publication_handle()) continue;
      const auto [found, is_new] = fusion.beacons.try_emplace(info.instance_handle().c_value());
      Losses& losses = found->second;
      if (is_new && !has_begun) losses.before = status.events_lost;
      losses.latest = status.events_lost;
      losses.taken = now;
    }
  });
}

/// Takes statuses until each fusion has one of each of its beacons since `since`.
void LossyFusions::wait_for_statuses(SteadyTime since, TimeNs max_ns, bool has_begun,
                                     const process::StopSignal& stop) {
  const SteadyTime end = clocks::steady_now() + max_ns;
  do {
    take(has_begun);
    const bool are_complete = std::all_of(fusions_.begin(), fusions_.end(), [&](const auto& entry) {
      return entry.second.has_status_since(since);
    });
    if (are_complete) return;
  } while (clocks::steady_now() < end && !stop.wait_until(clocks::steady_now() + status_poll_ns));
}

void LossyFusions::warn(const process::StopSignal& stop) {
  constexpr TimeNs max_ns = 300'000'000;  // for discovery, and for the latest statuses, which are latched
  const SteadyTime end = clocks::steady_now() + max_ns;
  while (find() && clocks::steady_now() < end) {
    if (stop.wait_until(clocks::steady_now() + status_poll_ns)) return;
  }
  if (fusions_.empty()) return;
  statuses_.emplace(topics::make_reader(participant_, qos_, topics::fusion_status));
  wait_for_statuses(clocks::steady_now(), max_ns, false, stop);
}

std::uint64_t LossyFusions::count_lost(const process::StopSignal& stop) {
  constexpr TimeNs late_ns = 100'000'000;  // the fusion still waits for missing events
  constexpr TimeNs max_ns = 3'000'000'000;
  find();
  if (!statuses_) return 0;
  take(true);
  wait_for_statuses(clocks::steady_now() + late_ns, max_ns, true, stop);
  std::uint64_t sum = 0;
  for (const auto& [key, fusion] : fusions_) {
    const std::uint64_t lost = fusion.lost();
    sum += lost;
    if (lost == 0) continue;
    logging::warning(fmt::format("{} has lost {}: start it with --lossless for --rate 0", fusion.name,
                                 text::count_text(lost, "event")));
  }
  return sum;
}

bool LossyFusions::Fusion::has_status_since(SteadyTime begin) const {
  return !beacons.empty() && std::all_of(beacons.begin(), beacons.end(), [begin](const auto& entry) {
    return !(entry.second.taken < begin);
  });
}

std::uint64_t LossyFusions::Fusion::lost() const {
  std::uint64_t sum = 0;
  for (const auto& [instance, losses] : beacons)
    sum += losses.latest - std::min(losses.before, losses.latest);
  return sum;
}

}  // namespace sonopose::publication
