#pragma once
/// \file
/// Collects the observations of one beacon.

#include "doctor/probe/latest.hpp"
#include "doctor/probe/pair_losses.hpp"
#include "doctor/rules/observations.hpp"
#include <sonopose/samples/fix_refusal.hpp>
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace sonopose::doctor::probe {

/// Arrival times of a sample.
struct Arrival {
  // NOLINTNEXTLINE(google-explicit-constructor): where the two clocks are one, as in a recording
  Arrival(TimeNs both_ns) : time_ns(both_ns), host_ns(both_ns) {}
  Arrival(TimeNs time, HostTime host, TimeNs unwatched)
      : time_ns(time), host_ns(host), unwatched_ns(unwatched) {}

  TimeNs time_ns;           ///< steady time, which is not set during the run
  HostTime host_ns;         ///< host time, for comparison with the bridge's stamps
  TimeNs unwatched_ns = 0;  ///< pause of the doctor just before, which is no silence of the stream
};

/// Deadlines of the streams in the QoS profiles; infinite where there is none.
struct Deadlines {
  double imu_s = std::numeric_limits<double>::infinity();
  double fix_s = std::numeric_limits<double>::infinity();
  double heading_s = std::numeric_limits<double>::infinity();
  double pose_s = std::numeric_limits<double>::infinity();
};

/// Observes one beacon. Before `begin`, only sequence numbers are used. Times are of the steady clock (ns).
/// Streams and statuses are counted over the whole window; numbers, means and fits cover its last two
/// minutes.
class BeaconProbe {
public:
  void on(const ImuSample& imu, const Arrival& arrival, std::uint64_t writer);
  void on(const UltrasonicFix& fix, const Arrival& arrival);
  void on(const PairHeading& heading, const Arrival& arrival);
  void on(const TwistSample& twist, const Arrival& arrival);
  void on(const FusedPose& pose, const Arrival& arrival);
  void on(const FixReport& report, const Arrival& arrival);
  void on(const BeaconStatus& status);
  void on(const FusionStatus& status);
  /// Ends a fusion until its next status: another one has taken its place.
  void end_fusion(std::uint64_t fusion_id);

  /// Starts the window. Silences longer than the deadlines are counted.
  void begin(TimeNs now_ns, const Deadlines& deadlines);

  /// The observations from `begin` to `now_ns`, with the settings of its fusion. The caller fills in address,
  /// pieces and bridges.
  [[nodiscard]] rules::BeaconObservation observation(TimeNs now_ns, const settings::Settings& settings) const;

  /// Fits the installation to IMU and fixes, which takes a while (motion::fit::pieces_of).
  [[nodiscard]] std::vector<motion::fit::Piece> pieces(const settings::Settings& settings,
                                                       const std::function<bool()>& is_stopped = {}) const;

  /// Writers of its IMU samples, by the handles given to `on`.
  [[nodiscard]] const std::set<std::uint64_t>& writers() const { return writers_; }

private:
  /// Counters of one stream.
  struct Stream {
    std::uint64_t samples = 0;
    double deadline_s = 0;
    TimeNs last_ns = 0;
    TimeNs longest_ns = 0;
    TimeNs silent_ns = 0;  ///< total of the silences longer than the deadline
    std::uint64_t silences = 0;
    void begin(TimeNs now_ns, double stream_deadline_s);
    void count(const Arrival& arrival);
    void add_silence(TimeNs length_ns);
    [[nodiscard]] rules::StreamObservation observation(TimeNs began_ns, TimeNs ended_ns) const;
  };

  /// Treatment of one fix by the fusion.
  struct Outcome {
    std::uint32_t flags = 0;
    std::optional<FixRefusal> refusal;
    Vector3d innovation_world_m = Vector3d::Zero();
    Vector3d jump_world_m = Vector3d::Zero();
  };

  [[nodiscard]] rules::FixOutcomes fix_outcomes() const;
  [[nodiscard]] bool stood_by(const rules::FusionSpan& ended) const;
  [[nodiscard]] std::optional<double> bridge_ahead_s() const;
  void count_missing_events(TimeNs ended_ns, rules::BeaconObservation& beacon) const;
  [[nodiscard]] motion::Window motion_window(const settings::Settings& settings) const;
  [[nodiscard]] bool in_window() const { return began_ns_ != 0; }

  TimeNs began_ns_ = 0;
  Stream imu_;
  Stream fix_;
  Stream heading_;
  Stream pose_;
  std::uint64_t pair_headings_ = 0;
  std::uint64_t valid_pair_headings_ = 0;
  PairLosses pair_losses_;
  std::uint64_t timed_fixes_ = 0;
  std::optional<double> min_fix_delay_s_;
  std::uint64_t pair_fixes_ = 0;
  rules::StatusCounts status_counts_;
  Latest<Outcome> outcomes_;
  std::set<std::uint64_t> writers_;
  Latest<std::uint64_t> sequences_;  ///< event numbers
  std::uint64_t last_imu_sequence_ = 0;
  Latest<ImuSample> readings_;          ///< uncorrected readings
  Latest<double> ahead_s_;              ///< the bridge's stamp minus the host's time of reception
  Latest<UltrasonicFix> fixes_;         ///< of one tag: several do not move alike
  std::optional<Vector3d> tag_body_m_;  ///< its place
  Latest<PairHeading> headings_;        ///< valid headings
  Latest<TwistSample> twists_;
  std::optional<BeaconStatus> status_before_;
  std::optional<BeaconStatus> status_;
  struct FusionObservation {
    rules::FusionSpan span;
    bool has_ended = false;
  };
  std::map<std::uint64_t, FusionObservation> fusions_;  ///< by fusion id
};

/// The settings of a fusion. Values that cannot be parsed keep their defaults.
settings::Settings settings_from(const EffectiveSettings& settings);

}  // namespace sonopose::doctor::probe
