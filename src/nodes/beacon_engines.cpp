#include <sonopose/nodes/beacon_engines.hpp>

#include <utility>

namespace sonopose::nodes {

BeaconEngines::BeaconEngines(config::FusionConfig config, bool lossless)
    : config_(std::move(config)), lossless_(lossless) {}

BeaconEngines::Beacon& BeaconEngines::beacon_of(BeaconAddress address) {
  auto& beacon = beacons_[address];
  if (!beacon) beacon = std::make_unique<Beacon>(config_.for_beacon(address));
  return *beacon;
}

bool BeaconEngines::Beacon::starts_over(const Event& event) {
  const std::uint64_t restarts = sequencer.counters().restarts + lossless_sequencer.counters().restarts;
  if (restarts == restarts_seen) return false;
  restarts_seen = restarts;
  return available_at_ns(event) < engine.state().body.time_ns;
}

void BeaconEngines::reset(BeaconAddress address) {
  for (auto& [known, beacon] : beacons_) {
    if (known == address || address == all_beacons) beacon->engine.reset();
  }
}

std::optional<FusionStatus> BeaconEngines::status(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return std::nullopt;
  const Beacon& beacon = *found->second;
  const fusion::Counters& counted = beacon.engine.counters();
  const fusion::SequencerCounters& order =
      lossless_ ? beacon.lossless_sequencer.counters() : beacon.sequencer.counters();
  FusionStatus status;
  status.address = address;
  status.imu_samples = counted.imu_samples;
  status.fixes_used = counted.fixes_used;
  status.fixes_rejected = counted.fixes_rejected;
  status.headings = counted.headings;
  status.events_lost = order.lost;
  status.events_duplicated = order.duplicated;
  status.samples_invalid = counted.samples_invalid;
  status.imu_gaps = counted.imu_gaps;
  status.reset_counter = beacon.engine.reset_counter();
  return status;
}

std::vector<BeaconAddress> BeaconEngines::addresses() const {
  std::vector<BeaconAddress> addresses;
  addresses.reserve(beacons_.size());
  for (const auto& entry : beacons_) addresses.push_back(entry.first);
  return addresses;
}

}  // namespace sonopose::nodes
