#pragma once
/// \file
/// The columns of a recording, filled sample by sample.

#include "transitions/pose_watch.hpp"
#include "transitions/transition_log.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <map>
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
  /// {"t": [...], "x": [...]}; t is in seconds since the begin, null is unknown. Every so many-th row if
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
  /// `duration_s`: about how long the recording is.
  explicit Document(double duration_s);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document() = default;

  void add(const FusedPose& pose);
  void add(const FixReport& report);
  void add(const TruthSample& truth);
  void add(const StationaryBeacon& beacon);

  [[nodiscard]] bool has_poses() const;
  std::string json();

private:
  struct Beacon {
    Beacon(BeaconAddress address, TimeNs begin_ns, TimeNs least_period_ns);

    Columns poses;
    Columns fixes;
    Columns truth;
    transitions::PoseWatch watch;
  };

  /// The beacon of a sample at this time.
  Beacon& beacon(BeaconAddress address, TimeNs time_ns);
  /// Puts what a sample at `time_ns` has changed into words.
  void take(transitions::Pending& pending, TimeNs time_ns);

  TimeNs begin_ns_ = 0;  ///< of the first sample
  TimeNs end_ns_ = 0;    ///< of the latest
  TimeNs least_period_ns_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::map<BeaconAddress, Vector3d> stationary_world_m_;
  TimeNs now_ns_ = 0;  ///< of the sample that is being added
  std::string events_;
  transitions::TransitionLog transition_log_;
};

}  // namespace sonopose::web::recording
