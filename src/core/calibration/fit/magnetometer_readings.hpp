#pragma once
/// \file
/// Choice of a recording's points for the fit of an ellipsoid, and the directions that they cover. Private to
/// this folder.

#include "calibration/fit/ellipsoid.hpp"
#include <sonopose/samples/samples.hpp>

#include <span>

namespace sonopose::calibration::fit::detail {

/// Range of nearly all readings: about the middle of the ellipsoid, and half of its widest span.
struct Span {
  Vector3d middle_ut = Vector3d::Zero();
  double half_ut = 0;
};

/// All finite readings, in µT. Throws CalibrationError if there are too few.
Points fields_of(std::span<const ImuSample> imu);

/// Throws CalibrationError if the readings span nothing.
Span span_of(const Points& points_ut);

/// Keeps at most a few readings from each small cube, so that a long rest in one direction counts no more
/// than a fast turn through another. Returns them relative to the span's middle, in units of its half.
Points thinned(const Points& points_ut, const Span& span);

/// Removes readings so far from all others that only an error explains them: a single one would bend the
/// ellipsoid to itself. Throws CalibrationError like span_of().
Points without_glitches(const Points& points_ut);

/// Share of 48 equal parts of the sphere that contain a corrected reading. Parameters as in ellipsoid.hpp.
double coverage_of(const Points& points, const Eigen::VectorXd& parameters);

}  // namespace sonopose::calibration::fit::detail
