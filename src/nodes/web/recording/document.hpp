#pragma once
/// \file
/// Columns of a recording, filled sample by sample.

#include "observation/beacon_observer.hpp"
#include "observation/first_reports.hpp"
#include "transitions/transition_detector.hpp"
#include "transitions/transition_log.hpp"
#include "web/live/missing_lines.hpp"
#include <sonopose/samples/log_line.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::web::recording {

/// Rows of numbers with their times. Skips a row that follows the previous one too closely.
class Columns {
public:
  Columns(std::vector<std::string_view> names, TimeNs begin_ns, TimeNs min_period_ns);

  /// `values`: the values after the time, in the order of the names.
  void add(TimeNs time_ns, std::span<const double> values);
  [[nodiscard]] std::size_t size() const { return columns_.front().size(); }
  /// {"t": [...], "x": [...]}; t is in seconds since the beginning, null is unknown. Thinned to every n-th
  /// row if there are more than `max_rows`.
  [[nodiscard]] std::string json(std::size_t max_rows) const;

private:
  std::vector<std::string_view> names_;
  std::vector<std::vector<double>> columns_;
  TimeNs begin_ns_;
  TimeNs min_period_ns_;
  TimeNs next_ns_;
};

class Document {
public:
  /// `duration_s`: approximate length of the recording. `beacon`: the only one whose log lines are shown;
  /// empty: those of all.
  explicit Document(double duration_s, std::optional<BeaconAddress> beacon = {});
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document() = default;

  /// Most log lines to keep, and most changes of state: the latest. The page shows fewer, of both together.
  static constexpr std::size_t max_kept = 20'000;

  /// `received_ns`: reception by the recorder, for the latency; empty for a pose that was made just now.
  void add(const FusedPose& pose, std::optional<TimeNs> received_ns = {});
  void add(const FixReport& report);
  void add(const TruthSample& truth);
  void add(const StationaryBeacon& beacon);
  void add(const BeaconStatus& status) { observers_[status.address].on(status); }
  void add(const FusionStatus& status) { observers_[status.address].on(status); }
  void add(const Estimate& estimate) { observers_[estimate.address].on(estimate); }
  void add(const LogLine& line);

  /// Announces that later samples were recorded at `now_ns` or later. After each second, each beacon with a
  /// pose in it gets one row of its statuses and poses. The row has the time of that pose, because statuses
  /// have another time in a replay.
  void advance(TimeNs now_ns);

  [[nodiscard]] bool has_poses() const;
  std::string json();

private:
  struct Event {
    TimeNs time_ns = 0;
    std::size_t lines = 1;  ///< number of shown lines: one more if lines are missing before it
    std::string change;     ///< named change, if a fusion has logged it or the poses show it
    std::string json;
  };
  using Events = std::deque<Event>;

  struct Beacon {
    Beacon(BeaconAddress address, TimeNs begin_ns, TimeNs min_period_ns);

    Columns poses;
    Columns fixes;
    Columns truth;
    Columns status;
    observation::FirstReports reports;  ///< a recording does not say whose they are
    transitions::TransitionDetector detector;
    std::optional<TimeNs> latest_ns;  ///< latest pose in this second
  };

  /// The beacon of a sample at this time.
  Beacon& beacon(BeaconAddress address, TimeNs time_ns);
  void end_second();
  void keep(Events& events, Event event);
  /// The latest events by time, and the number of those left out.
  std::vector<Event> shown_events();
  /// Formats the changes by a sample at `time_ns`.
  void take(transitions::TransitionQueue& transitions, TimeNs time_ns);

  TimeNs begin_ns_ = 0;  ///< time of the first sample
  TimeNs end_ns_ = 0;    ///< time of the latest sample
  TimeNs min_period_ns_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::map<BeaconAddress, observation::BeaconObserver> observers_;  ///< includes beacons without poses
  std::map<BeaconAddress, Vector3d> stationary_world_m_;
  std::optional<TimeNs> second_end_ns_;
  TimeNs now_ns_ = 0;  ///< time of the current sample
  std::optional<BeaconAddress> beacon_;
  Events changes_;  ///< changes seen in the poses
  Events log_lines_;
  live::MissingLines missing_lines_;
  std::uint64_t events_left_out_ = 0;
  transitions::TransitionLog transition_log_;
};

}  // namespace sonopose::web::recording
