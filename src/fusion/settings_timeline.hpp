#pragma once
/// \file
/// Which settings one beacon's engine shall use at which of its events.

#include "config/beacon_settings.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonopose::fusion {

/// The settings in force, and changes that wait for their event.
class SettingsTimeline {
public:
  /// As many changes, each with a number of its own, can wait.
  static constexpr std::size_t capacity = 64;

  enum class Scope : bool { for_all, own };

  explicit SettingsTimeline(config::BeaconSettings settings) : begin_(std::move(settings)) {}

  /// Goes on to an event: true where other settings hold from this one on. Allocates nothing.
  bool advance(std::uint64_t sequence) {
    const std::size_t before = reached_;
    while (reached_ < steps_.size() && steps_[reached_].from_sequence <= sequence) ++reached_;
    return reached_ != before;
  }

  /// In force at the event that was reached, as the user gave them.
  [[nodiscard]] const settings::Settings& settings() const { return in_force().settings(); }

  /// In force from an event on that may lie ahead.
  [[nodiscard]] const settings::Settings& settings_at(std::uint64_t sequence) const;

  /// The number of the last change; 0 where none waits for a number.
  [[nodiscard]] std::uint64_t last_from_sequence() const {
    return steps_.empty() ? 0 : steps_.back().from_sequence;
  }

  /// Whether one more change can wait for this number.
  [[nodiscard]] bool has_room_for(std::uint64_t from_sequence) const;

  /// Adds a change that holds from the event of this number on; 0: from the next event, whatever its number.
  /// Of changes for the same number the last one counts. Without room, the change with the lowest number does
  /// not wait any longer.
  void add(std::uint64_t from_sequence, Scope scope, const config::Assignments& assignments);

private:
  struct Step {
    std::uint64_t from_sequence = 0;
    config::Assignments for_all;
    config::Assignments own;
    config::BeaconSettings after;  ///< in force from here on
  };

  [[nodiscard]] const config::BeaconSettings& in_force() const {
    return reached_ == 0 ? begin_ : steps_[reached_ - 1].after;
  }
  [[nodiscard]] std::size_t waiting() const { return steps_.size() - reached_; }
  void forget_reached();
  Step& step_at(std::uint64_t from_sequence);

  config::BeaconSettings begin_;
  std::vector<Step> steps_;  ///< by number, each once
  std::size_t reached_ = 0;  ///< steps that hold already; they are kept until the next change is added
};

}  // namespace sonopose::fusion
