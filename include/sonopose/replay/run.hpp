#pragma once
/// \file
/// The engine over a whole recording: the same engine as in the live fusion, without bus and without clock.
/// The same recording and settings give the same bits.

#include <sonopose/attitude/strapdown.hpp>
#include <sonopose/core/pose.hpp>
#include <sonopose/fusion/settings.hpp>
#include <sonopose/fusion/state.hpp>
#include <sonopose/io/log_folder.hpp>
#include <sonopose/replay/score.hpp>
#include <sonopose/replay/verdicts.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace sonopose::replay {

enum class EngineKind : std::uint8_t {
  fusion,
  strapdown  ///< the IMU alone, from the recording's first complete truth sample
};

/// An engine between two events of a recording.
struct SavedState {
  fusion::Snapshot snapshot;
  std::uint64_t sequence = 0;  ///< of the last event that it was given; 0 before the first
  BeaconAddress beacon = 0;    ///< whose recording it was
  TimeNs first_event_ns = 0;   ///< when that recording's first event came

  bool operator==(const SavedState&) const = default;
};

struct RunOptions {
  fusion::Settings settings{};
  EngineKind engine = EngineKind::fusion;
  attitude::StrapdownRule strapdown_rule = attitude::StrapdownRule::previous;
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
  fusion::Counters counters;
  VerdictCounts verdicts;
  bool has_truth = false;
  Score fused;
  ErrorSummary last_fix_m;      ///< at the same moments, from the first fix on
  ErrorSummary extrapolated_m;  ///< the same
  std::string state_hash;       ///< digest of every pose and of the state at the end
  SavedState end;               ///< of the fusion
};

/// Runs. Throws std::invalid_argument where there is nothing to run on: a recording without IMU samples, a
/// start that lies behind its end, the strapdown engine without truth.
RunResult run(const io::SensorLog& log, const RunOptions& options, const Observer& observer = {});

/// The first truth sample with position, attitude and velocity; empty where none is complete.
std::optional<TruthSample> first_complete_truth(const io::SensorLog& log);

}  // namespace sonopose::replay
