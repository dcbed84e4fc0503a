#pragma once
/// \file
/// The start of the search for the maximum: mount and delay from a grid. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <functional>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// Largest offset of the clocks that is searched, to each side.
inline constexpr double max_clock_offset_s = 3.0;

struct Start {
  Parameters parameters;
  std::vector<double> start_yaw_rad;  ///< per log; 0 with headings
};

/// Most probable yaw, of several in all directions, at the start of a log without headings.
double best_start_yaw_rad(const Measurements& log, double delay_s);

/// Most probable point of a grid over all mounts and delays of up to 150 ms. Its noise is so large that the
/// neighbours of the right point explain the logs.
Start grid_search(const std::vector<Measurements>& logs);

/// Most probable delay of up to 3 s to both sides, on a coarse grid: the clocks of fixes and IMU may differ.
/// `logs` are whole.
double coarse_delay_s(const std::vector<Measurements>& logs, const std::function<void(int step)>& observer);

/// Removes fixes and headings that contradict the others at this start.
void reject_outliers(std::vector<Measurements>& logs, const Start& start);

/// Removes fixes and headings that are far from a fit, more than five times as far as most. Returns false if
/// there are none.
bool reject_tail(std::vector<Measurements>& logs, const std::vector<Pass>& passes);

}  // namespace sonopose::calibration::drive::detail
