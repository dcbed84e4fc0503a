#pragma once
/// \file
/// One beacon in the fusion: its estimator, the order of its events, the changes of its settings, and the
/// state of its inputs.

#include "estimation/digest.hpp"
#include "fusion/fix_refusals.hpp"
#include "fusion/settings_timeline.hpp"
#include "process/heard.hpp"
#include "process/silence.hpp"
#include "transitions/pose_watch.hpp"
#include <sonopose/collation/collator.hpp>
#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace sonopose::fusion {

/// Settings that apply from an event on.
struct SettingsChange {
  BeaconAddress address = 0;
  std::uint64_t from_sequence = 0;
  settings::Settings settings;  ///< effective: the preset is resolved
};

/// Everything that one event gave.
struct EventOutcome {
  std::optional<TimeNs> prediction_period_ns;  ///< at the beacon's first event and where settings change
  estimation::EventResult result;              ///< a pose, a report on a fix, or nothing
};

/// Not thread-safe.
class BeaconEstimator {
public:
  /// `lossless`: wait for a missing event without a time limit instead of for a few milliseconds.
  BeaconEstimator(BeaconAddress address, SettingsTimeline timeline, bool lossless);

  /// Puts an event that arrived at `now` from the writer with the publication handle `bridge` in its order.
  /// `attended` is `now` by collation::AttendedTime.
  /// Returns the events that are in line now; pass each to `process`. The span is valid until the next call.
  std::span<const collation::CollatedEvent> collate(const Event& event, std::uint64_t bridge, SteadyTime now,
                                                    SteadyTime attended);

  /// Applies the settings that are due at this event and passes the event to the estimator. Does not
  /// allocate.
  EventOutcome process(const collation::CollatedEvent& collated) noexcept;

  /// Does what a fix or heading has left to do, once its result is written.
  void catch_up() noexcept { estimator_.catch_up(); }

  /// Resets the estimator; settings are kept. A request that repeats the last one does nothing: same id, not
  /// 0.
  void reset(std::uint64_t request_id);

  [[nodiscard]] const SettingsTimeline& timeline() const { return timeline_; }

  /// Replaces the settings, which apply from the next event on. The former ones are left in `timeline`.
  void exchange_timeline(SettingsTimeline& timeline) { std::swap(timeline_, timeline); }

  /// The settings that changed with an event; empty if none have since the last call.
  std::optional<SettingsChange> take_settings_change();

  /// The number of the latest event that was processed; empty if there was none.
  [[nodiscard]] std::optional<std::uint64_t> last_sequence() const { return last_sequence_; }

  /// Adds deadline periods without a sample.
  void on_deadline_missed(std::uint64_t FusionStatus::*counter, std::uint64_t more) {
    counted_.*counter += more;
  }

  /// A bridge is no longer alive: counts it if it sent the latest IMU sample.
  void on_bridge_lost(std::uint64_t bridge, SteadyTime now) noexcept;

  /// Whether the IMU has fallen silent for `deadline_ns` or resumed since the last call.
  bool find_silence_change(SteadyTime now, TimeNs deadline_ns);

  /// Whether `find_silence_change` or `transitions` has a change.
  [[nodiscard]] bool has_unreported_change(SteadyTime now, TimeNs deadline_ns) const {
    return !pending_.empty() || imu_silence_.has_changed(now, deadline_ns);
  }

  /// The changes of state since they were last cleared.
  [[nodiscard]] transitions::Pending& transitions() { return pending_; }

  /// Whether nothing has arrived for so long that the estimate is worthless (see process::Heard).
  [[nodiscard]] bool is_gone(SteadyTime now) const;

  /// Its counters, without those of the process.
  [[nodiscard]] FusionStatus status() const;

  /// What the estimator has learned about the sensors.
  [[nodiscard]] Estimate estimate();

  /// The digest of every pose and of the present state, as a replay of the same events gives it.
  [[nodiscard]] std::string state_hash();

  /// What the user has to know about refused fixes (see FixRefusals). Call it once a second.
  std::optional<std::string> fix_refusals(SteadyTime now) { return refusals_.update(now); }

  /// The gap that the events wait for; empty if none wait, and unless lossless.
  [[nodiscard]] std::optional<collation::LosslessCollator::Gap> gap() const;

private:
  [[nodiscard]] const collation::CollatorCounters& order_counters() const;

  FusionStatus counted_;  ///< what is not counted elsewhere
  SettingsTimeline timeline_;
  estimation::AnyEstimator estimator_;
  std::variant<collation::Collator, collation::LosslessCollator> collator_;
  std::optional<std::uint64_t> last_sequence_;
  std::optional<std::uint64_t> settings_changed_at_;  ///< since the last take_settings_change()
  std::uint64_t last_reset_id_ = 0;
  process::Heard heard_;
  process::Silence imu_silence_;
  std::uint64_t bridge_ = 0;  ///< that sent the latest IMU sample
  std::optional<SteadyTime> bridge_lost_at_;
  FixRefusals refusals_;
  estimation::Digest poses_;
  transitions::PoseWatch watch_;
  transitions::Pending pending_;
};

}  // namespace sonopose::fusion
