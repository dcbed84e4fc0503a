#include "monitor/counters_since.hpp"

#include "observation/status_counters.hpp"

#include <array>
#include <set>

namespace sonopose::monitor {
namespace {

constexpr double was_there_before_s = 5.0;  // time of discovery on a network

template <class Status, std::size_t Size>
void subtract(Status& status, Status& begin,
              const std::array<observation::StatusCounter<Status>, Size>& counters) {
  for (const auto& counter : counters) {
    if (status.*counter.value < begin.*counter.value) begin = {};  // its process has restarted
  }
  for (const auto& counter : counters) status.*counter.value -= begin.*counter.value;
}

}  // namespace

void CountersSince::apply(std::vector<observation::BeaconView>& views, double running_s) {
  const bool was_there_before = running_s <= was_there_before_s;
  for (observation::BeaconView& view : views) {
    if (view.bridge) {
      const BeaconStatus begin = was_there_before ? *view.bridge : BeaconStatus{};
      subtract(*view.bridge, bridges_.try_emplace(view.address, begin).first->second,
               observation::bridge_counters);
    }
    for (FusionStatus& fusion : view.fusions) {
      const FusionStatus begin = was_there_before ? fusion : FusionStatus{};
      const std::pair key{view.address, fusion.fusion_id};
      subtract(fusion, fusions_.try_emplace(key, begin).first->second, observation::fusion_counters);
    }
    if (!view.fusions.empty()) view.fusion = view.fusions.front();
    const auto own = own_.find(view.address);
    if (own == own_.end()) continue;
    if (view.deadlines_missed < own->second.deadlines_missed || view.losses < own->second.losses) {
      own_.erase(own);  // the beacon was gone and has returned
      continue;
    }
    view.deadlines_missed -= own->second.deadlines_missed;
    view.losses -= own->second.losses;
  }
  forget_ended_fusions(views);
}

void CountersSince::forget_ended_fusions(const std::vector<observation::BeaconView>& views) {
  if (fusions_.size() <= 16 * views.size() + 64) return;
  std::set<std::pair<BeaconAddress, std::uint64_t>> present;
  for (const auto& view : views) {
    for (const FusionStatus& fusion : view.fusions) present.emplace(view.address, fusion.fusion_id);
  }
  std::erase_if(fusions_, [&](const auto& entry) { return !present.contains(entry.first); });
}

void CountersSince::clear(const std::vector<observation::BeaconView>& received) {
  for (const observation::BeaconView& view : received) {
    if (view.bridge) bridges_[view.address] = *view.bridge;
    for (const FusionStatus& fusion : view.fusions) fusions_[{view.address, fusion.fusion_id}] = fusion;
    own_[view.address] = {view.deadlines_missed, view.losses};
  }
}

}  // namespace sonopose::monitor
