#pragma once
/// \file
/// The settings of one beacon as a function of the event number.

#include "config/beacon_settings.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonopose::fusion {

/// The effective settings, and changes that wait for their event.
class SettingsTimeline {
public:
  /// Number of changes with different event numbers that can wait.
  static constexpr std::size_t capacity = 16;

  enum class Scope : bool { for_all, own };

  explicit SettingsTimeline(config::BeaconSettings settings) : begin_(std::move(settings)) {}

  /// Advances to an event. Returns true if the settings change with it. Does not allocate.
  bool advance(std::uint64_t sequence) {
    const std::size_t before = reached_;
    while (reached_ < steps_.size() && steps_[reached_].from_sequence <= sequence) ++reached_;
    return reached_ != before;
  }

  /// Settings at the present event, as the user gave them.
  [[nodiscard]] const settings::Settings& settings() const { return effective().settings(); }

  /// Settings at an event that may lie ahead.
  [[nodiscard]] const settings::Settings& settings_at(std::uint64_t sequence) const;

  /// Calls `visit(settings)` for the settings at an event and after each later change.
  void for_each_from(std::uint64_t sequence, const auto& visit) const {
    visit(settings_at(sequence));
    for (std::size_t i = reached_; i < steps_.size(); ++i) {
      if (steps_[i].from_sequence > sequence) visit(steps_[i].after.settings());
    }
  }

  /// Event number of the last change; 0 if there is none.
  [[nodiscard]] std::uint64_t last_from_sequence() const {
    return steps_.empty() ? 0 : steps_.back().from_sequence;
  }

  /// Settings after all waiting changes.
  [[nodiscard]] const config::BeaconSettings& at_end() const {
    return steps_.empty() ? begin_ : steps_.back().after;
  }

  /// True if the beacon has settings of its own, now or after a waiting change.
  [[nodiscard]] bool has_own() const { return at_end().has_own(); }

  /// True if another change can wait for this event number.
  [[nodiscard]] bool can_add(std::uint64_t from_sequence) const;

  /// Adds a change that applies from this event number on; 0: from the next event. A later change for the
  /// same number replaces an earlier one. If `can_add` is false, the change with the lowest number applies
  /// immediately.
  void add(std::uint64_t from_sequence, Scope scope, const config::Assignments& assignments);

private:
  struct Step {
    std::uint64_t from_sequence = 0;
    config::Assignments for_all;
    config::Assignments own;
    config::BeaconSettings after;  ///< effective from this event on
  };

  [[nodiscard]] const config::BeaconSettings& effective() const {
    return reached_ == 0 ? begin_ : steps_[reached_ - 1].after;
  }
  [[nodiscard]] std::size_t waiting() const { return steps_.size() - reached_; }
  void remove_reached();
  Step& step_at(std::uint64_t from_sequence);

  config::BeaconSettings begin_;
  std::vector<Step> steps_;  ///< ordered by number, each once
  std::size_t reached_ = 0;  ///< number of steps that apply; removed when the next change is added
};

}  // namespace sonopose::fusion
