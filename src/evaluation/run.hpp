#pragma once
/// \file
/// Runs the engine over a whole recording: the same engine as in the live fusion, without DDS and without a
/// clock. The same recording and settings give bit-identical results.

#include "evaluation/fix_flag_counts.hpp"
#include "evaluation/score.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/estimation/documented/state.hpp>
#include <sonopose/estimation/strapdown/strapdown.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace sonopose::evaluation {

enum class EngineKind : std::uint8_t {
  fusion,
  strapdown  ///< IMU only, starting at the recording's first complete truth sample
};

/// State of an engine between two events of a recording.
struct SavedState {
  estimation::documented::Snapshot snapshot;
  std::uint64_t sequence = 0;  ///< of the last processed event; 0 before the first
  BeaconAddress beacon = 0;    ///< beacon of the recording
  TimeNs first_event_ns = 0;   ///< time of the recording's first event

  bool operator==(const SavedState&) const = default;
};

struct RunOptions {
  settings::Settings settings{};
  EngineKind engine = EngineKind::fusion;
  estimation::StrapdownRule strapdown_rule = estimation::StrapdownRule::previous;
  double after_s = 0;                 ///< score poses from this long after the recording's first event
  std::optional<double> until_s{};    ///< stop before the first two consecutive events that are later
  std::optional<SavedState> start{};  ///< continue from this state with the events after it
};

/// Callbacks during a run; either may be empty.
struct Observer {
  std::function<void(const FusedPose&)> on_pose;
  std::function<void(const FixReport&)> on_report;
};

/// Result of a run. All counts are for this run only.
struct RunResult {
  std::uint64_t events = 0;
  std::uint64_t poses = 0;
  double duration_s = 0;              ///< from the first processed event to the last
  std::uint64_t imu_stamps_back = 0;  ///< IMU samples with an earlier time stamp than the previous one
  estimation::documented::Counters counters;
  FixFlagCounts fix_flags;
  bool has_truth = false;
  Score fused;
  ErrorSummary last_fix_m;      ///< error of the latest fix at the same times, after the first fix
  ErrorSummary extrapolated_m;  ///< error of the extrapolated fix
  std::string state_hash;       ///< digest of every pose and of the final state
  SavedState end;               ///< final state of the fusion
};

/// Runs an engine over a recording. Throws std::invalid_argument if the recording is empty, if the start is
/// after its end, or if the strapdown engine has no truth to start from.
RunResult run(const recording::SensorLog& log, const RunOptions& options, const Observer& observer = {});

/// The first truth sample with position, attitude and velocity; empty if none is complete.
std::optional<TruthSample> first_complete_truth(const recording::SensorLog& log);

}  // namespace sonopose::evaluation
