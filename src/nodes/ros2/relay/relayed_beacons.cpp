#include "ros2/relay/relayed_beacons.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sonopose::ros2::relay {

RelayedBeacons::Publishers RelayedBeacons::find_or_request(BeaconAddress address, SteadyTime now) {
  const threads::Lock lock(mutex_);
  const auto [found, is_new] = beacons_.try_emplace(address);
  Beacon& beacon = found->second;
  beacon.presence.on_sample(now);
  if (is_new) {
    has_requests_ = true;
    wakeup_.wake();
  }
  return beacon.publishers;
}

RelayedBeacons::Publishers RelayedBeacons::find(BeaconAddress address) {
  const threads::Lock lock(mutex_);
  const auto found = beacons_.find(address);
  return found == beacons_.end() ? nullptr : found->second.publishers;
}

std::map<BeaconAddress, RelayedBeacons::Publishers> RelayedBeacons::all() {
  std::map<BeaconAddress, Publishers> all;
  const threads::Lock lock(mutex_);
  for (const auto& [address, beacon] : beacons_) {
    if (beacon.publishers) all.emplace(address, beacon.publishers);
  }
  return all;
}

std::vector<BeaconAddress> RelayedBeacons::requested() {
  std::vector<BeaconAddress> requested;
  const threads::Lock lock(mutex_);
  if (!std::exchange(has_requests_, false)) return requested;
  for (const auto& [address, beacon] : beacons_) {
    if (!beacon.publishers) requested.push_back(address);
  }
  return requested;
}

void RelayedBeacons::add(BeaconAddress address, Publishers publishers) {
  const threads::Lock lock(mutex_);
  if (const auto found = beacons_.find(address); found != beacons_.end()) {
    found->second.publishers = std::move(publishers);
  }
}

RelayedBeacons::Publishers RelayedBeacons::take_kept(BeaconAddress address) {
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.address == address; });
  if (found == kept_.end()) return nullptr;
  Publishers publishers = std::move(found->publishers);
  kept_.erase(found);
  return publishers;
}

std::vector<RelayedBeacons::Gone> RelayedBeacons::remove_gone(SteadyTime now) {
  std::vector<Gone> gone;
  const threads::Lock lock(mutex_);
  std::erase_if(beacons_, [&](auto& entry) {
    auto& [address, beacon] = entry;
    if (!beacon.presence.is_gone(now)) return false;
    const bool keeps = beacon.publishers && beacon.presence.is_established();
    gone.push_back({address, keeps});
    if (keeps) {
      kept_.push_back({address, std::move(beacon.publishers)});
    } else if (beacon.publishers) {
      removed_.push_back(std::move(beacon.publishers));
    }
    return true;
  });
  return gone;
}

std::vector<BeaconAddress> RelayedBeacons::remove_surplus() {
  std::size_t present = 0;
  {
    const threads::Lock lock(mutex_);
    present = beacons_.size();
  }
  std::vector<BeaconAddress> surplus;
  while (!kept_.empty() && present + kept_.size() > max_beacons_) {
    surplus.push_back(kept_.front().address);
    removed_.push_back(std::move(kept_.front().publishers));
    kept_.erase(kept_.begin());
  }
  return surplus;
}

std::vector<RelayedBeacons::Publishers> RelayedBeacons::take_unused() {
  const auto in_use = std::partition(removed_.begin(), removed_.end(),
                                     [](const Publishers& publishers) { return publishers.use_count() > 1; });
  std::vector<Publishers> unused(std::make_move_iterator(in_use), std::make_move_iterator(removed_.end()));
  removed_.erase(in_use, removed_.end());
  return unused;
}

}  // namespace sonopose::ros2::relay
