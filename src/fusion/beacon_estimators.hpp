#pragma once
/// \file
/// One estimator per beacon address, made when the beacon's first event arrives. Collates the beacon's events
/// and applies requested changes of settings.

#include "config/fusion_config.hpp"
#include "fusion/fix_refusals.hpp"
#include "fusion/settings_timeline.hpp"
#include <sonopose/collation/collator.hpp>
#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace sonopose::fusion {

/// Settings that apply from an event on.
struct SettingsChange {
  BeaconAddress address = 0;
  std::uint64_t from_sequence = 0;
  settings::Settings settings;  ///< effective: the preset is resolved
};

/// Everything that one event gave.
struct EventOutcome {
  std::optional<SettingsChange> settings;  ///< at the beacon's first event and where settings change
  estimation::EventResult result;          ///< a pose, a report on a fix, or nothing
};

/// Not thread-safe.
class BeaconEstimators {
public:
  /// `lossless`: wait for a missing event without a time limit instead of for a few milliseconds.
  BeaconEstimators(const config::FusionConfig& config, bool lossless);

  /// Puts an event that arrived at `now` in its beacon's order. Returns the events that are
  /// in line now; pass each to `process`. The span is valid until the next call for the same beacon.
  std::span<const collation::CollatedEvent> collate(const Event& event, SteadyTime now);

  /// Applies the settings that are due at this event and passes the event to the estimator. Does not
  /// allocate.
  EventOutcome process(const collation::CollatedEvent& collated) noexcept;

  /// Does what a fix or heading has left to do, once its result is written.
  void catch_up(BeaconAddress address) noexcept;

  /// Resets the estimator of one beacon, or of all for all_beacons. Settings are kept.
  void reset(BeaconAddress address);

  /// Checks a request and applies it completely or, if the reply refuses it, not at all. A repeated request
  /// gets the reply to the first one.
  SettingsReply change_settings(const SettingsRequest& request);

  /// The settings of a beacon without settings of its own, after all accepted changes for all beacons. Its
  /// address is all_beacons, its from_sequence that of the last of these changes.
  [[nodiscard]] SettingsChange settings_for_all() const;

  /// The counters of one beacon; empty for an unknown address.
  [[nodiscard]] std::optional<FusionStatus> status(BeaconAddress address) const;

  /// What the user has to know about refused fixes of one beacon (see FixRefusals). Call it once a second.
  [[nodiscard]] std::optional<std::string> fix_refusals(BeaconAddress address, SteadyTime now);

  /// What one beacon's estimator has learned about the sensors; empty for an unknown address.
  [[nodiscard]] std::optional<Estimate> estimate(BeaconAddress address) const;

  /// The gap that one beacon's events wait for; empty if none wait, and unless lossless.
  [[nodiscard]] std::optional<collation::LosslessCollator::Gap> gap(BeaconAddress address) const;

  /// The beacons from which events have arrived.
  [[nodiscard]] std::vector<BeaconAddress> addresses() const;

private:
  struct Beacon {
    Beacon(SettingsTimeline& settings, bool lossless);

    [[nodiscard]] const collation::CollatorCounters& order_counters() const;

    SettingsTimeline& timeline;
    estimation::AnyEstimator estimator;
    std::variant<collation::Collator, collation::LosslessCollator> collator;
    std::optional<std::uint64_t> last_sequence;  ///< of the latest event that the estimator processed
    std::uint64_t fixes_late = 0;
    FixRefusals refusals;
  };

  Beacon& beacon_of(BeaconAddress address);
  SettingsTimeline& timeline_of(BeaconAddress address);
  [[nodiscard]] std::optional<std::uint64_t> last_sequence(BeaconAddress address) const;
  /// The first event of a change for each known beacon: "7: event 812, 9: event 501".
  [[nodiscard]] std::string first_events(std::uint64_t from_sequence) const;
  /// The number itself, or 0 if that event is past already.
  [[nodiscard]] std::uint64_t ahead(BeaconAddress address, std::uint64_t sequence) const;
  void check_capacity(const SettingsTimeline& timeline, BeaconAddress address,
                      std::uint64_t from_sequence) const;
  static void check_possible(SettingsTimeline timeline, const std::string& whose, std::uint64_t from_sequence,
                             SettingsTimeline::Scope scope, const config::Assignments& assignments);
  void carry_out(const SettingsRequest& request, SettingsReply& reply);

  bool lossless_;
  SettingsTimeline default_timeline_;                    ///< of beacons without a timeline
  std::map<BeaconAddress, SettingsTimeline> timelines_;  ///< of known and configured beacons
  std::unordered_map<BeaconAddress, std::unique_ptr<Beacon>> beacons_;
  std::deque<SettingsReply> replies_;  ///< the latest
};

}  // namespace sonopose::fusion
