#pragma once
/// \file
/// Writes the data of a plot as gnuplot's named blocks.

#include "plots/plot.hpp"

#include <string>

namespace sonopose::plots {

/// Blocks of run K:
///     $pathK       1-2 x y, 3-4 true x y
///     $posesK      1 time, 2 speed, 3 true speed, 4 error, 5 error of the last fix, 6 trust, 7 z,
///                  8-9 z -+ 3 sigma, 10 true z, 11 3 sigma of the position
///     $yawK        1 time, 2 yaw, 3-4 yaw -+ 3 sigma, 5 true yaw
///     $ellipsesK   1-2 centre, 3-4 axes, 5 angle
///     $fixesK      1 time, 2-4 x y z, 5-6 innovation along and left, 7-8 3 sigma of them, 9 weight,
///                  10 speed, 11 class, 12 seen flags
///     $histogramK  1 innovation, 2-3 share along and left
/// The recording has $headings (1 time, 2 heading), $arrivals (1 time, 2 delay, 3 quality); the first run has
/// $status (1 time, 2 stale, 3 converging), $silences (1 time, 2 silence of the IMU). Blank lines end the
/// curves before a silence.
///
/// Seconds, m, m/s, degrees; errors and innovations in cm, delays in ms, quality and shares in percent.
std::string data_blocks(const PlotData& data);

}  // namespace sonopose::plots
