#pragma once
/// \file
/// The mount from the direction of travel of a vehicle that drives along its X axis. It needs no
/// accelerometer. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <optional>
#include <span>

namespace sonopose::calibration::drive::detail {

struct CourseMount {
  double mount_rad = 0;
  double spread_rad = 0;  ///< spread of heading minus course, corrected for turning
  int windows = 0;        ///< number of windows with a course
};

/// The mount is the heading of the pair minus the direction of the fixes' motion over half a second, where
/// the gyroscope measures no turning: a line is fitted to these differences over the curvature of the path.
/// The fixes may be anywhere in front of or behind the axle. Empty if too few windows have motion.
std::optional<CourseMount> mount_from_course(std::span<const Measurements> logs);

}  // namespace sonopose::calibration::drive::detail
