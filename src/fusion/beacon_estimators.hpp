#pragma once
/// \file
/// One engine for each beacon address, made when its first event arrives, with its events put in order and
/// its settings changed where a request says.

#include "config/fusion_config.hpp"
#include "fusion/settings_timeline.hpp"
#include <sonopose/collation/collator.hpp>
#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace sonopose::fusion {

/// Settings that an engine uses from one event on.
struct SettingsInForce {
  BeaconAddress address = 0;
  std::uint64_t from_sequence = 0;
  settings::Settings settings;  ///< as the engine uses them: the preset is resolved
};

/// Not for several threads at once: no locks.
class BeaconEstimators {
public:
  /// `lossless`: wait for a missing event without end, rather than for a few milliseconds.
  BeaconEstimators(const config::FusionConfig& config, bool lossless);

  /// Takes an event that arrived at `now` (steady clock) and calls `on_pose(FusedPose&)` and
  /// `on_report(const FixReport&)` for what came of it, and of those that waited for it; before these,
  /// `on_settings(const SettingsInForce&)` at a beacon's first event and where other settings take hold.
  template <class OnPose, class OnReport, class OnSettings>
  void push(const Event& event, SteadyTime now, const OnPose& on_pose, const OnReport& on_report,
            const OnSettings& on_settings) {
    const BeaconAddress address = address_of(event);
    Beacon& beacon = beacon_of(address);
    const auto deliver = [&](const Event& next) {
      if (beacon.starts_over(next)) beacon.engine.reset();
      const std::uint64_t sequence = sequence_of(next);
      if (beacon.goes_on_to(sequence)) on_settings({address, sequence, beacon.engine.settings()});
      if (const auto* imu = std::get_if<ImuSample>(&next)) {
        if (auto pose = beacon.engine.on(*imu)) on_pose(*pose);
      } else if (const auto* fix = std::get_if<UltrasonicFix>(&next)) {
        on_report(beacon.engine.on(*fix));
      } else {
        beacon.engine.on(std::get<PairHeading>(next));
      }
    };
    if (auto* live = std::get_if<collation::Collator>(&beacon.order)) {
      live->push(event, now, deliver);
    } else {
      std::get<collation::LosslessCollator>(beacon.order).push(event, deliver);
    }
  }

  /// The same for who does not ask which settings hold.
  template <class OnPose, class OnReport>
  void push(const Event& event, SteadyTime now, const OnPose& on_pose, const OnReport& on_report) {
    push(event, now, on_pose, on_report, [](const SettingsInForce&) {});
  }

  /// Re-initialises one beacon's engine, or every one's for all_beacons. Settings stay as they are.
  void reset(BeaconAddress address);

  /// Checks a request for other settings and takes it over: whole, or, where the answer says so, not at all.
  /// A request that comes again is answered as it was the first time.
  SettingsReply change_settings(const SettingsRequest& request);

  /// What a beacon uses that has nothing of its own, once every change for all beacons that was accepted
  /// holds; the address is all_beacons, the number that of the last of these changes.
  [[nodiscard]] SettingsInForce settings_for_all() const;

  /// What one beacon's engine has counted; empty for an address never heard of.
  [[nodiscard]] std::optional<FusionStatus> status(BeaconAddress address) const;

  /// What one beacon's events wait for; empty where nothing waits, and where not lossless.
  [[nodiscard]] std::optional<collation::LosslessCollator::Gap> gap(BeaconAddress address) const;

  /// Every address heard of.
  [[nodiscard]] std::vector<BeaconAddress> addresses() const;

private:
  struct Beacon {
    Beacon(SettingsTimeline& settings, bool lossless);

    /// A bridge that was started anew and plays older times: nothing of the old state holds.
    bool starts_over(const Event& event);

    /// The event that comes next; true where the engine uses other settings from it on, and at the first.
    bool goes_on_to(std::uint64_t sequence) {
      const bool first = !last_sequence;
      last_sequence = sequence;
      if (!timeline.advance(sequence)) return first;
      engine.configure(timeline.settings());
      return true;
    }

    [[nodiscard]] const collation::CollatorCounters& order_counters() const;

    SettingsTimeline& timeline;
    estimation::documented::Engine engine;
    std::variant<collation::Collator, collation::LosslessCollator> order;
    std::uint64_t restarts_seen = 0;
    std::optional<std::uint64_t> last_sequence;  ///< of the latest event that the engine was given
  };

  Beacon& beacon_of(BeaconAddress address);
  SettingsTimeline& timeline_of(BeaconAddress address);
  [[nodiscard]] std::optional<std::uint64_t> last_sequence(BeaconAddress address) const;
  /// From which event on a change holds for each beacon that was heard: "7: event 812, 9: event 501".
  [[nodiscard]] std::string first_events(std::uint64_t from_sequence) const;
  /// The number itself, or 0 where that event is past already.
  [[nodiscard]] std::uint64_t ahead(BeaconAddress address, std::uint64_t sequence) const;
  void check_room(const SettingsTimeline& timeline, BeaconAddress address, std::uint64_t from_sequence) const;
  void carry_out(const SettingsRequest& request, SettingsReply& reply);

  bool lossless_;
  SettingsTimeline others_;                              ///< of any beacon that has none of its own yet
  std::map<BeaconAddress, SettingsTimeline> timelines_;  ///< of those heard of or named
  std::unordered_map<BeaconAddress, std::unique_ptr<Beacon>> beacons_;
  std::deque<SettingsReply> replies_;  ///< the latest
};

}  // namespace sonopose::fusion
