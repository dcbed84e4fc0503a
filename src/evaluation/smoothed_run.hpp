#pragma once
/// \file
/// Runs the Kalman engine over a recording and smooths its trajectory with the measurements that follow.

#include "evaluation/run.hpp"

namespace sonopose::evaluation {

/// Like `run`, but the poses that the observer gets, and the score `fused`, are those of the smoother; the
/// reports, prediction errors, counters and the hash are those of the engine. A sample without a smoothed
/// pose, as before the first fix, gives no pose. Of the status, the bits remain that describe the
/// measurements: stale, frozen track, IMU gap and low trust. `smoothing` has the score of the engine. Throws
/// std::invalid_argument as `run` does, for another engine than the Kalman engine, if the options start from
/// a saved state, and if the settings let the engine estimate the delay.
RunResult run_smoothed(const recording::SensorLog& log, const RunOptions& options,
                       const Observer& observer = {});

}  // namespace sonopose::evaluation
