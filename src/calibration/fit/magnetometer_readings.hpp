#pragma once
/// \file
/// From a recording to the points through which an ellipsoid is laid, and which directions they have. Private
/// to this folder.

#include "calibration/fit/ellipsoid.hpp"
#include <sonopose/samples/samples.hpp>

#include <span>

namespace sonopose::calibration::fit::detail {

/// Where nearly all readings lie: about the middle of the ellipsoid, and half of its widest span.
struct Span {
  Vector3d middle_ut = Vector3d::Zero();
  double half_ut = 0;
};

/// All finite readings, in µT. Throws CalibrationError where they are too few.
Points fields_of(std::span<const ImuSample> imu);

/// Throws CalibrationError where the readings span nothing.
Span span_of(const Points& points_ut);

/// At most a few readings from each small cube, so that a long rest in one direction counts no more than a
/// fast turn through another. From the span's middle, in units of its half.
Points thinned(const Points& points_ut, const Span& span);

/// Without the readings so far from all others that no field but only an error explains them: a single one
/// would bend the ellipsoid to itself. Throws CalibrationError as span_of() does.
Points without_glitches(const Points& points_ut);

/// Share of 48 equal parts of the sphere in which a corrected reading points. Parameters as in ellipsoid.hpp.
double coverage_of(const Points& points, const Eigen::VectorXd& parameters);

}  // namespace sonopose::calibration::fit::detail
