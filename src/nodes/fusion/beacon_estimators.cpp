#include "fusion/beacon_estimators.hpp"

#include <sonopose/settings/preset.hpp>

#include <algorithm>
#include <utility>

namespace sonopose::fusion {

BeaconEstimators::BeaconEstimators(const config::FusionConfig& config, bool lossless,
                                   KnownSensorsOf known_sensors_of)
    : lossless_(lossless),
      known_sensors_of_(std::move(known_sensors_of)),
      default_timeline_(config.beacon(all_beacons)) {
  for (const BeaconAddress address : config.beacons()) {
    later_timelines_.emplace(address, config.beacon(address));
  }
}

const std::shared_ptr<BeaconEstimator>& BeaconEstimators::find_or_make(BeaconAddress address) {
  auto& estimator = estimators_[address];
  if (!estimator) {
    const auto scheduled = later_timelines_.extract(address);
    estimator = std::make_shared<BeaconEstimator>(
        address, scheduled.empty() ? default_timeline_ : std::move(scheduled.mapped()), lossless_);
    const auto known =
        known_sensors_of_ ? known_sensors_of_(address, estimator->timeline().settings()) : std::nullopt;
    if (known) estimator->start_from(*known);
  }
  return estimator;
}

BeaconEstimator* BeaconEstimators::find(BeaconAddress address) const {
  const auto found = estimators_.find(address);
  return found == estimators_.end() ? nullptr : found->second.get();
}

bool BeaconEstimators::have_unreported_changes(SteadyTime now, TimeNs deadline_ns) const {
  return std::ranges::any_of(
      estimators_, [&](const auto& entry) { return entry.second->has_unreported_change(now, deadline_ns); });
}

std::vector<BeaconAddress> BeaconEstimators::addresses() const {
  std::vector<BeaconAddress> addresses;
  addresses.reserve(estimators_.size());
  for (const auto& entry : estimators_) addresses.push_back(entry.first);
  return addresses;
}

std::vector<std::pair<BeaconAddress, std::shared_ptr<BeaconEstimator>>> BeaconEstimators::remove_gone(
    SteadyTime now) {
  std::vector<std::pair<BeaconAddress, std::shared_ptr<BeaconEstimator>>> gone;
  for (const auto& [address, estimator] : estimators_) {
    if (estimator->is_gone(now)) gone.emplace_back(address, estimator);
  }
  for (const auto& [address, estimator] : gone) {
    estimators_.erase(address);
    if (estimator->timeline().has_own()) later_timelines_.emplace(address, estimator->timeline());
  }
  return gone;
}

void BeaconEstimators::reset(BeaconAddress address, std::uint64_t request_id) {
  for (auto& [known, estimator] : estimators_) {
    if (known == address || address == all_beacons) estimator->reset(request_id);
  }
}

std::vector<SettingsChange> BeaconEstimators::take_settings_changes() {
  std::vector<SettingsChange> changes;
  for (auto& entry : estimators_) {
    if (auto change = entry.second->take_settings_change()) changes.push_back(*change);
  }
  return changes;
}

SettingsChange BeaconEstimators::settings_for_all() const {
  return {all_beacons, default_timeline_.last_from_sequence(),
          settings::resolved(default_timeline_.at_end().settings())};
}

BeaconEstimators::Schedule BeaconEstimators::schedule(BeaconAddress address) const {
  if (const BeaconEstimator* estimator = find(address)) {
    return {estimator->timeline(), estimator->last_sequence()};
  }
  const auto later = later_timelines_.find(address);
  return {later == later_timelines_.end() ? default_timeline_ : later->second, std::nullopt};
}

std::vector<BeaconAddress> BeaconEstimators::scheduled() const {
  std::vector<BeaconAddress> addresses = this->addresses();
  for (const auto& entry : later_timelines_) addresses.push_back(entry.first);
  std::sort(addresses.begin(), addresses.end());
  return addresses;
}

void BeaconEstimators::exchange_timeline(BeaconAddress address, SettingsTimeline& timeline) {
  if (address == all_beacons) {
    std::swap(default_timeline_, timeline);
  } else if (BeaconEstimator* estimator = find(address)) {
    estimator->exchange_timeline(timeline);
  } else {
    std::swap(later_timelines_.try_emplace(address, default_timeline_).first->second, timeline);
  }
}

}  // namespace sonopose::fusion
