#pragma once
/// \file
/// The engine over a whole recording: the same engine as in the live fusion, without bus and without clock.
/// The same recording and settings give the same bits.

#include <sonopose/estimation/strapdown/strapdown.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>
#include <sonopose/estimation/documented/state.hpp>
#include "recording/log_folder.hpp"
#include "evaluation/score.hpp"
#include "evaluation/fix_flag_counts.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace sonopose::evaluation {

enum class EngineKind : std::uint8_t {
  fusion,
  strapdown  ///< the IMU alone, from the recording's first complete truth sample
};

/// An engine between two events of a recording.
struct SavedState {
  estimation::documented::Snapshot snapshot;
  std::uint64_t sequence = 0;  ///< of the last event that it was given; 0 before the first
  BeaconAddress beacon = 0;    ///< whose recording it was
  TimeNs first_event_ns = 0;   ///< when that recording's first event came

  bool operator==(const SavedState&) const = default;
};

struct RunOptions {
  settings::Settings settings{};
  EngineKind engine = EngineKind::fusion;
  estimation::StrapdownRule strapdown_rule = estimation::StrapdownRule::previous;
  double after_s = 0;                 ///< scored are poses from so long after the recording's first event on
  std::optional<double> until_s{};    ///< the run ends before the first two events in a row that come later
  std::optional<SavedState> start{};  ///< go on from here, with the events behind it
};

/// What is told as it comes; either may be empty.
struct Observer {
  std::function<void(const FusedPose&)> on_pose;
  std::function<void(const FixReport&)> on_report;
};

/// What a run did; counted over this run alone.
struct RunResult {
  std::uint64_t events = 0;
  std::uint64_t poses = 0;
  double duration_s = 0;              ///< from the first event that was used to the last
  std::uint64_t imu_stamps_back = 0;  ///< IMU samples with an earlier stamp than the one before
  estimation::documented::Counters counters;
  FixFlagCounts fix_flags;
  bool has_truth = false;
  Score fused;
  ErrorSummary last_fix_m;      ///< at the same moments, from the first fix on
  ErrorSummary extrapolated_m;  ///< the same
  std::string state_hash;       ///< digest of every pose and of the state at the end
  SavedState end;               ///< of the fusion
};

/// Runs. Throws std::invalid_argument where there is nothing to run on: a recording without IMU samples, a
/// start that lies behind its end, the strapdown engine without truth.
RunResult run(const recording::SensorLog& log, const RunOptions& options, const Observer& observer = {});

/// The first truth sample with position, attitude and velocity; empty where none is complete.
std::optional<TruthSample> first_complete_truth(const recording::SensorLog& log);

}  // namespace sonopose::evaluation
