#include "fusion/settings_timeline.hpp"

#include <algorithm>
#include <iterator>

namespace sonopose::fusion {

const settings::Settings& SettingsTimeline::settings_at(std::uint64_t sequence) const {
  const config::BeaconSettings* found = &effective();
  for (std::size_t i = reached_; i < steps_.size() && steps_[i].from_sequence <= sequence; ++i) {
    found = &steps_[i].after;
  }
  return found->settings();
}

bool SettingsTimeline::can_add(std::uint64_t from_sequence) const {
  const auto waits = [from_sequence](const Step& step) { return step.from_sequence == from_sequence; };
  const auto first = steps_.begin() + static_cast<std::ptrdiff_t>(reached_);
  return waiting() < capacity || std::any_of(first, steps_.end(), waits);
}

void SettingsTimeline::add(std::uint64_t from_sequence, Scope scope, const config::Assignments& assignments) {
  if (!can_add(from_sequence)) ++reached_;
  remove_reached();
  Step& changed = step_at(from_sequence);
  auto& values = scope == Scope::own ? changed.own : changed.for_all;
  for (const auto& [key, value] : assignments) values.insert_or_assign(key, value);

  // Each step adds to the settings of the previous one.
  config::BeaconSettings settings = begin_;
  for (Step& step : steps_) {
    settings.assign_own(step.own);
    settings.assign_for_all(step.for_all);
    step.after = settings;
  }
}

void SettingsTimeline::remove_reached() {
  begin_ = effective();
  steps_.erase(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(reached_));
  reached_ = 0;
}

SettingsTimeline::Step& SettingsTimeline::step_at(std::uint64_t from_sequence) {
  const auto place =
      std::lower_bound(steps_.begin(), steps_.end(), from_sequence,
                       [](const Step& step, std::uint64_t number) { return step.from_sequence < number; });
  if (place != steps_.end() && place->from_sequence == from_sequence) return *place;
  return *steps_.insert(place, Step{.from_sequence = from_sequence, .for_all = {}, .own = {}, .after = {}});
}

}  // namespace sonopose::fusion
