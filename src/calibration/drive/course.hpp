#pragma once
/// \file
/// The mount from the direction of travel, for a vehicle that drives along its X axis. It needs no
/// accelerometer. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <optional>
#include <span>

namespace sonopose::calibration::drive::detail {

struct CourseMount {
  double mount_rad = 0;
  double spread_rad = 0;  ///< of the heading minus the course, the turning taken out
  int windows = 0;        ///< in which there is a course
};

/// The heading of the pair minus the direction in which the fixes of half a second move, where the gyro
/// measures no turning: a line through these differences over the curvature of the path. The fixes may be
/// anywhere in front of or behind the axle. Empty if there are too few windows with motion.
std::optional<CourseMount> mount_from_course(std::span<const Measurements> logs);

}  // namespace sonopose::calibration::drive::detail
