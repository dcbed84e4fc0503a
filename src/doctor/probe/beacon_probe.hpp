#pragma once
/// \file
/// Collects the observations of one beacon.

#include "doctor/probe/latest.hpp"
#include "doctor/rules/observations.hpp"
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace sonopose::doctor::probe {

/// Of samples before `begin` only the sequence numbers are used. Times are of the host's clock (ns). Streams
/// and statuses are counted over the whole window; numbers, means and fits are those of its last two minutes.
class BeaconProbe {
public:
  void on(const ImuSample& imu, TimeNs received_ns, std::uint64_t writer);
  void on(const UltrasonicFix& fix, TimeNs received_ns);
  void on(const PairHeading& heading, TimeNs received_ns);
  void on(const FusedPose& pose, TimeNs received_ns);
  void on(const FixReport& report);
  void on(const BeaconStatus& status);
  void on(const FusionStatus& status);

  /// Starts the window.
  void begin(TimeNs now_ns);

  /// The observations from `begin` to `now_ns`, with the settings of its fusion. Address, deadlines and
  /// bridges are left for the caller.
  [[nodiscard]] rules::BeaconObservation observation(TimeNs now_ns, const settings::Settings& settings,
                                                     const std::function<bool()>& is_stopped = {}) const;

  /// The writers of its IMU samples: the handles given to `on`.
  [[nodiscard]] const std::set<std::uint64_t>& writers() const { return writers_; }

private:
  /// Counters of one stream.
  struct Stream {
    std::uint64_t samples = 0;
    TimeNs last_ns = 0;
    TimeNs longest_ns = 0;
    void count(TimeNs received_ns);
    [[nodiscard]] rules::StreamObservation observation(TimeNs began_ns, TimeNs ended_ns) const;
  };

  [[nodiscard]] std::optional<double> bridge_ahead_s() const;
  [[nodiscard]] std::uint64_t missing_events(TimeNs ended_ns) const;
  [[nodiscard]] motion::Window motion_window(const settings::Settings& settings) const;
  [[nodiscard]] bool in_window() const { return began_ns_ != 0; }

  TimeNs began_ns_ = 0;
  Stream imu_;
  Stream fix_;
  Stream heading_;
  Stream pose_;
  std::uint64_t valid_headings_ = 0;
  std::uint64_t timed_fixes_ = 0;
  std::uint64_t pair_fixes_ = 0;
  rules::StatusCounts status_counts_;
  rules::FixOutcomes fix_outcomes_;
  std::set<std::uint64_t> writers_;
  Latest<std::uint64_t> sequences_;  ///< event numbers
  std::uint64_t last_imu_sequence_ = 0;
  Latest<ImuSample> readings_;  ///< uncorrected
  Latest<UltrasonicFix> fixes_;
  Latest<PairHeading> headings_;  ///< the valid ones
  std::optional<BeaconStatus> status_before_;
  std::optional<BeaconStatus> status_;
  struct FusionObservation {
    FusionStatus before;
    FusionStatus latest;
  };
  std::map<std::uint64_t, FusionObservation> fusions_;  ///< by fusion id
};

/// The settings of a fusion. Values that cannot be parsed keep their defaults.
settings::Settings settings_from(const EffectiveSettings& settings);

}  // namespace sonopose::doctor::probe
