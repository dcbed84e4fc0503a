#pragma once
/// \file
/// Runs the Kalman engine over a recording and smooths its trajectory with later measurements.

#include "evaluation/replay/run.hpp"

namespace sonopose::evaluation {

/// Variant of `run` in which the observer's poses and the score `fused` are those of the smoother. Reports,
/// prediction errors, counters and the hash are those of the engine, whose score is in `smoothing`. A sample
/// without a smoothed pose, as before the first fix, gives no pose. The status keeps only the bits that
/// describe the measurements: stale, frozen track, IMU gap, low trust, IMU inconsistent and fixes
/// inconsistent. Throws std::invalid_argument like `run`. Also throws for another engine than the Kalman
/// engine, a saved start, planar motion, and settings that let the engine estimate the delay.
RunResult run_smoothed(const recording::SensorLog& log, const RunOptions& options,
                       const Observer& observer = {});

}  // namespace sonopose::evaluation
