#pragma once
/// \file
/// Runs the live fusion's estimator over a recording, without bus and clock. The same recording and settings
/// give the same bits.

#include "evaluation/replay/strapdown.hpp"
#include "evaluation/score/fix_flag_counts.hpp"
#include "evaluation/score/prediction_errors.hpp"
#include "evaluation/score/score.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/estimation/aiding/fix_refusals.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/offline/smoother.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::evaluation {

/// The state of an estimator between two events of a recording.
struct SavedState {
  estimation::AnySnapshot snapshot;
  std::uint64_t sequence = 0;    ///< number of the last processed event; 0 before the first
  BeaconAddress beacon = 0;      ///< address of the recording's beacon
  TimeNs first_event_ns = 0;     ///< time of the recording's first event
  std::uint64_t last_event = 0;  ///< digest of the last processed event; 0 before the first

  bool operator==(const SavedState&) const = default;
};

/// Digest of an event's time and values.
std::uint64_t digest_of(const Event& event);

struct RunOptions {
  settings::Settings settings{};
  std::optional<strapdown::Rule> strapdown{};  ///< integrate the IMU alone, instead of running an engine
  double after_s = 0;               ///< score poses from this time after the recording's first event on
  std::optional<double> until_s{};  ///< stop before the first two consecutive events that are later than this
  std::optional<SavedState> start{};  ///< continue from this state with the following events
};

/// Warnings of the status that a run counts, with their names.
inline constexpr std::array<std::pair<PoseStatus, std::string_view>, 8> run_warnings{
    {{status_initialising, "initialising"},
     {status_imu_inconsistent, "IMU inconsistent"},
     {status_fixes_inconsistent, "fixes inconsistent"},
     {status_low_trust, "low trust"},
     {status_heading_unknown, "heading unknown"},
     {status_frozen_track, "frozen track"},
     {status_imu_gap, "IMU gap"},
     {status_stale, "stale"}}};

/// Callbacks for each output; either may be empty.
struct Observer {
  std::function<void(const FusedPose&)> on_pose;
  std::function<void(const FixReport&)> on_report;
};

/// Additional results of a smoothed run.
struct Smoothing {
  Score engine;  ///< score of the engine's own poses at times with a smoothed pose
  estimation::offline::Noise noise;
};

/// Velocities or headings of which none could be used.
struct UnusedInput {
  bool is_heading = false;
  std::string text;
};

/// The result of one run. Counters count only this run.
struct RunResult {
  std::uint64_t events = 0;
  std::uint64_t poses = 0;
  double duration_s = 0;              ///< time from the first to the last processed event
  std::uint64_t imu_stamps_back = 0;  ///< IMU samples with an earlier stamp than their predecessor
  EstimatorCounters counters;
  FixFlagCounts fix_flags;
  FixFlagCounts rejected_fix_flags;  ///< flags of the unused fixes
  estimation::aiding::RefusedFixes refusals;
  std::vector<UnusedInput> unused_inputs{};
  /// Texts about what contradicts the settings: heights, velocities.
  std::vector<std::string> remarks{};
  std::uint64_t judged_poses = 0;                ///< from RunOptions::after_s on
  std::map<PoseStatus, std::uint64_t> warned{};  ///< numbers of these with a warning, by its bit
  std::uint64_t fixes_down_weighted = 0;         ///< number of used fixes with reduced weight
  bool has_truth = false;
  Score fused;
  ErrorSummary last_fix_m;      ///< error at the same times, from the first fix on
  ErrorSummary extrapolated_m;  ///< error at the same times, from the first fix on
  PredictionScore prediction;
  std::optional<Smoothing> smoothing{};  ///< set if `fused` is the score of the smoothed poses
  std::string state_hash;                ///< digest of every pose and of the final state
  SavedState end;                        ///< without a snapshot after strapdown integration
};

/// Runs an engine over a recording, or strapdown integration from the first complete truth sample. Throws
/// std::invalid_argument if the recording has no samples, or strapdown integration has no truth to start from
/// or is to continue a saved state. Also throws if `options.start` belongs to another recording or engine.
RunResult run(const recording::SensorLog& log, const RunOptions& options, const Observer& observer = {});

/// Returns the first truth sample with position, attitude and velocity; empty if none is complete.
std::optional<TruthSample> first_complete_truth(const recording::SensorLog& log);

}  // namespace sonopose::evaluation
