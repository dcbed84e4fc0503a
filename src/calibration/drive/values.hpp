#pragma once
/// \file
/// From the maximum of the likelihood to values with intervals, or to what is missing. Private to this
/// folder.

#include "calibration/drive/drive_fit.hpp"
#include "calibration/drive/scoring.hpp"

namespace sonopose::calibration::drive::detail {

/// Values, intervals and normalised innovations. A quantity whose interval is too wide gets the motion that
/// is missing.
void set_values(const Problem& problem, const Fit& fit, DriveFit& result);

/// If the fit needs an IMU much noisier than its samples are, the IMU does not measure the motion of the
/// fixes: then only the mount is known, from the course, if the vehicle drives along its X axis.
void check_imu(const Problem& problem, const Fit& fit, DriveFit& result);

/// The likelihood along each unknown of the fit.
void add_curves(const Problem& problem, const Fit& fit, DriveFit& result);

}  // namespace sonopose::calibration::drive::detail
