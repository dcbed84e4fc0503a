#pragma once
/// \file
/// One beacon in the fusion: its estimator, event order, changes of settings, and state of its inputs.

#include "estimation/digest.hpp"
#include "fusion/settings_timeline.hpp"
#include "fusion/twist_use.hpp"
#include "presence/beacon_presence.hpp"
#include "presence/silence.hpp"
#include "transitions/transition_detector.hpp"
#include <sonopose/collation/collator.hpp>
#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/estimation/aiding/fix_refusals.hpp>
#include <sonopose/estimation/aiding/height_check.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/sensor_fault_detector.hpp>
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
  settings::Settings settings;  ///< effective, with the preset resolved
};

/// Results of one event.
struct EventOutcome {
  bool settings_changed = false;    ///< also at the beacon's first event
  TimeNs prediction_period_ns = 0;  ///< by the new settings; 0: never
  estimation::EventResult result;   ///< pose, report on a fix, or nothing
};

/// The fusion of one beacon. Not thread-safe.
class BeaconEstimator {
public:
  /// `lossless`: wait for a missing event indefinitely instead of for a few milliseconds.
  BeaconEstimator(BeaconAddress address, SettingsTimeline timeline, bool lossless);
  BeaconEstimator(const BeaconEstimator&) = delete;
  BeaconEstimator& operator=(const BeaconEstimator&) = delete;
  ~BeaconEstimator() = default;

  /// Begins with known errors of the sensors (AnyEstimator::start_from).
  void start_from(const estimation::aiding::KnownSensors& known) noexcept { estimator_.start_from(known); }

  /// Sorts in an event that arrived at `now` from the writer with the publication handle `bridge`. `unpaused`
  /// is `now` by collation::PauseCompensatedClock. Call `process_next` until it returns nothing.
  void collate(const Event& event, std::uint64_t bridge, SteadyTime now, SteadyTime unpaused);

  /// Passes the next event in order to the estimator, with the settings that are due at it. Empty if none is
  /// left. First finishes the work that the previous event left until its result was published. Does not
  /// allocate.
  std::optional<EventOutcome> process_next() noexcept;

  /// Resets the estimator but keeps the settings. Ignores a repeated request: same id as the last one, not 0.
  void reset(std::uint64_t request_id);

  [[nodiscard]] const SettingsTimeline& timeline() const { return timeline_; }

  /// Replaces the settings from the next event on. Leaves the former ones in `timeline`.
  void exchange_timeline(SettingsTimeline& timeline) { std::swap(timeline_, timeline); }

  /// The settings that changed with an event since the last call; empty if none.
  std::optional<SettingsChange> take_settings_change();

  /// Number of the latest processed event; empty if there was none.
  [[nodiscard]] std::optional<std::uint64_t> last_sequence() const { return last_sequence_; }

  /// Adds deadline periods without a sample.
  void on_deadline_missed(std::uint64_t FusionStatus::*counter, std::uint64_t more) {
    counted_.*counter += more;
  }

  /// Reports that a bridge is no longer alive. It counts if it sent the latest IMU sample, unless
  /// `on_bridge_ended` follows soon, as at an end in good order.
  void on_bridge_lost(std::uint64_t bridge, SteadyTime now) noexcept;
  void on_bridge_ended(std::uint64_t bridge) noexcept;

  /// True if the bridge is lost, or the IMU has fallen silent for `deadline_ns` or resumed since the last
  /// call.
  bool find_silence_change(SteadyTime now, TimeNs deadline_ns);

  /// True if `find_silence_change` or `transitions` has a change.
  [[nodiscard]] bool has_unreported_change(SteadyTime now, TimeNs deadline_ns) const {
    return !transitions_.empty() || is_loss_due(now) || imu_silence_.has_changed(now, deadline_ns);
  }

  /// Changes of state since they were last cleared.
  [[nodiscard]] transitions::TransitionQueue& transitions() { return transitions_; }

  /// True if nothing has arrived for so long that the estimate is worthless (presence::BeaconPresence).
  [[nodiscard]] bool is_gone(SteadyTime now) const;

  /// The beacon's counters, without those of the process. None decreases.
  [[nodiscard]] FusionStatus status();

  /// The estimator's knowledge of the sensors.
  [[nodiscard]] Estimate estimate();

  /// Returns the estimate if a later start may use it and the latest pose is not in doubt.
  [[nodiscard]] std::optional<Estimate> learned();

  /// Digest of every pose and of the present state. A replay of the same events gives the same digest.
  [[nodiscard]] std::string state_hash();

  /// A message about refused fixes (estimation::aiding::FixRefusals), if there is news. Call it once a
  /// second.
  std::optional<std::string> fix_refusals(SteadyTime now) { return refusals_.update(now); }

  /// A message about fixes far from the height of a planar body, once until they agree.
  std::optional<std::string> height_use();

  /// A message about velocities, if there is news. Call it about once a second.
  std::optional<std::string> twist_use() {
    return twist_use_.update(estimator_.counters(), estimator_.settings());
  }

  /// The gap that events wait for; empty if none wait, and unless lossless.
  [[nodiscard]] std::optional<collation::LosslessCollator::Gap> gap() const;

private:
  EventOutcome process(const collation::CollatedEvent& collated) noexcept;
  [[nodiscard]] const collation::CollatorCounters& order_counters() const;
  /// True if a bridge lost its liveliness without a regular end.
  [[nodiscard]] bool is_loss_due(SteadyTime now) const {
    constexpr TimeNs end_ns = 300'000'000;
    return bridge_lost_at_ && !loss_is_counted_ && now - *bridge_lost_at_ >= end_ns;
  }

  FusionStatus counted_;  ///< counters that nothing else keeps, and those that must not decrease
  SettingsTimeline timeline_;
  estimation::AnyEstimator estimator_;
  estimation::SensorFaultDetector sensor_faults_;
  std::variant<collation::Collator, collation::LosslessCollator> collator_;
  std::span<const collation::CollatedEvent> in_order_;  ///< collated, not processed yet
  std::optional<std::uint64_t> last_sequence_;
  std::optional<std::uint64_t> settings_changed_at_;  ///< event number since the last take_settings_change()
  std::uint64_t last_reset_id_ = 0;
  presence::BeaconPresence presence_;
  presence::Silence imu_silence_;
  std::uint64_t bridge_ = 0;  ///< sender of the latest IMU sample
  std::optional<SteadyTime> bridge_lost_at_;
  bool loss_is_counted_ = false;
  estimation::aiding::FixRefusals refusals_;
  estimation::aiding::HeightCheck height_check_;
  bool height_contradicts_ = false;
  TwistUse twist_use_;
  std::uint32_t pose_status_ = status_initialising;  ///< status of the latest pose
  estimation::Digest poses_;
  transitions::TransitionDetector detector_;
  transitions::TransitionQueue transitions_;
};

}  // namespace sonopose::fusion
