#pragma once
/// \file
/// The columns of a recording, filled sample by sample.

#include "observation/beacon_observer.hpp"
#include "transitions/pose_watch.hpp"
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

/// Numbers by row, each row at a time; a row that follows the one before too closely is left out.
class Columns {
public:
  Columns(std::vector<std::string_view> names, TimeNs begin_ns, TimeNs least_period_ns);

  /// The values that follow the time, in the order of the names.
  void add(TimeNs time_ns, std::span<const double> values);
  [[nodiscard]] std::size_t size() const { return columns_.front().size(); }
  /// {"t": [...], "x": [...]}; t is in seconds since the beginning, null is unknown. Every so many-th row if
  /// there are more than `most_rows`.
  [[nodiscard]] std::string json(std::size_t most_rows) const;

private:
  std::vector<std::string_view> names_;
  std::vector<std::vector<double>> columns_;
  TimeNs begin_ns_;
  TimeNs least_period_ns_;
  TimeNs next_ns_;
};

class Document {
public:
  /// `duration_s`: about how long the recording is. `beacon`: the only one, whose log lines are shown; empty:
  /// the lines of all.
  explicit Document(double duration_s, std::optional<BeaconAddress> beacon = {});
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document() = default;

  /// Log lines that are kept, and changes of state: the latest. The page shows fewer, of both together.
  static constexpr std::size_t most_kept = 20'000;

  /// `received_ns`: when the recorder received the pose, for its latency; empty if it was made just now.
  void add(const FusedPose& pose, std::optional<TimeNs> received_ns = {});
  void add(const FixReport& report);
  void add(const TruthSample& truth);
  void add(const StationaryBeacon& beacon);
  void add(const BeaconStatus& status) { observers_[status.address].on(status); }
  void add(const FusionStatus& status) { observers_[status.address].on(status); }
  void add(const Estimate& estimate) { observers_[estimate.address].on(estimate); }
  void add(const LogLine& line);

  /// What is added from now on was recorded at `now_ns` or later. After each second, each beacon with a pose
  /// in it has one row more of what its statuses and poses have shown, at the time of that pose: in a replay,
  /// statuses are of another time.
  void advance(TimeNs now_ns);

  [[nodiscard]] bool has_poses() const;
  std::string json();

private:
  struct Event {
    TimeNs time_ns = 0;
    std::size_t lines = 1;  ///< that the page shows of it: one more if lines are missing before it
    std::string change;     ///< that it names, if a fusion has logged it or the poses show it
    std::string json;
  };
  using Events = std::deque<Event>;

  struct Beacon {
    Beacon(BeaconAddress address, TimeNs begin_ns, TimeNs least_period_ns);

    Columns poses;
    Columns fixes;
    Columns truth;
    Columns status;
    transitions::PoseWatch watch;
    std::optional<TimeNs> latest_ns;  ///< of the poses in this second
  };

  /// The beacon of a sample at this time.
  Beacon& beacon(BeaconAddress address, TimeNs time_ns);
  void end_second();
  void keep(Events& events, Event event);
  /// The latest, by their time, and how many were left out.
  std::vector<Event> shown_events();
  /// Puts what a sample at `time_ns` has changed into words.
  void take(transitions::Pending& pending, TimeNs time_ns);

  TimeNs begin_ns_ = 0;  ///< of the first sample
  TimeNs end_ns_ = 0;    ///< of the latest
  TimeNs least_period_ns_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::map<BeaconAddress, observation::BeaconObserver> observers_;  ///< also of those without poses
  std::map<BeaconAddress, Vector3d> stationary_world_m_;
  std::optional<TimeNs> second_end_ns_;
  TimeNs now_ns_ = 0;  ///< of the sample that is being added
  std::optional<BeaconAddress> beacon_;
  Events changes_;  ///< that the poses show
  Events log_lines_;
  live::MissingLines missing_lines_;
  std::uint64_t events_left_out_ = 0;
  transitions::TransitionLog transition_log_;
};

}  // namespace sonopose::web::recording
