#pragma once
/// \file
/// Values with intervals from the maximum of the likelihood, or the data that are missing. Private to this
/// folder.

#include "calibration/drive/drive_fit.hpp"
#include "calibration/drive/scoring.hpp"

#include <string>

namespace sonopose::calibration::drive::detail {

/// Sets values, intervals and normalised innovations. A quantity with too wide an interval gets the missing
/// motion instead.
void set_values(const Problem& problem, const Fit& fit, DriveFit& result);

/// End of a text about an IMU that contradicts the fixes: the clocks may differ.
std::string or_clocks();

/// Checks the IMU. If the fit needs one much noisier than its samples, the IMU does not measure the motion of
/// the fixes. Then only the mount is known, from the course, if the vehicle drives along its X axis.
void check_imu(const Problem& problem, const Fit& fit, DriveFit& result);

/// Adds the likelihood along each unknown of the fit.
void add_curves(const Problem& problem, const Fit& fit, DriveFit& result);

}  // namespace sonopose::calibration::drive::detail
