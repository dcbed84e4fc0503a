#pragma once
/// \file
/// Where the search for the maximum starts: mount and delay from a grid. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <vector>

namespace sonopose::calibration::drive::detail {

struct Start {
  Parameters parameters;
  std::vector<double> start_yaw_rad;  ///< per log; 0 with headings
};

/// The most probable yaw at the start of a log without headings, of some in all directions.
struct StartYaw {
  double yaw_rad = 0;
  double minus_2_log_l = 0;
};

StartYaw best_start_yaw(const Measurements& log, double delay_s);

/// The most probable point of a grid over all mounts and delays of up to 150 ms, with noise so large that the
/// neighbours of the right point explain the logs.
Start grid_search(const std::vector<Measurements>& logs);

/// Leaves out the fixes and headings that contradict the others at this start.
void leave_out_outliers(std::vector<Measurements>& logs, const Start& start);

}  // namespace sonopose::calibration::drive::detail
