#include "fusion/changed_settings.hpp"

#include <utility>

namespace sonopose::fusion {

std::vector<EffectiveSettings> ChangedSettings::update(BeaconAddress address) {
  const auto at_end = [this](BeaconAddress each) {
    return estimators_.with([each](auto& all) { return all.schedule(each); }).timeline.at_end();
  };
  std::vector<EffectiveSettings> updates;
  const auto add = [&](BeaconAddress each, std::vector<SettingAssignment> values) {
    updates.push_back({.address = each, .values = values});
    known_.insert_or_assign(each, std::move(values));
  };
  const config::BeaconSettings common = at_end(all_beacons);
  std::vector<BeaconAddress> beacons{address};
  if (address == all_beacons) beacons = estimators_.with([](auto& all) { return all.scheduled(); });
  for (const BeaconAddress each : beacons) {
    if (!addresses_.contains(each)) continue;
    const config::BeaconSettings settings = at_end(each);
    if (!settings.has_own() && !known_.contains(each)) continue;
    auto values = settings.own_texts();
    if (values != known_[each]) add(each, std::move(values));
  }
  auto values = config::changed_texts_of(common.settings());
  const auto known = known_.find(all_beacons);
  if (!updates.empty() || known == known_.end() || known->second != values) {
    add(all_beacons, std::move(values));
  }
  return updates;
}

}  // namespace sonopose::fusion
