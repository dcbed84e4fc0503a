#pragma once
/// \file
/// Least-squares fit of the ellipsoid |S·m − h| = 1 to points, with S symmetric and positive. Private to this
/// folder.

#include "calibration/fit/least_squares.hpp"
#include <sonopose/calibration/model/affine.hpp>

#include <vector>

namespace sonopose::calibration::fit::detail {

using Points = std::vector<Vector3d>;

// The nine parameters are S (xx, xy, xz, yy, yz, zz) and h.
Matrix3d soft_iron_of(const Eigen::VectorXd& parameters);

/// Approximate distance of each point from the ellipsoid, as if this were a sphere of its volume.
Eigen::VectorXd ellipsoid_residuals(const Points& points, const Eigen::VectorXd& parameters);

/// Initial parameters from the quadric m·Q·m + 2·n·m = 1 by linear least squares; a sphere about the mean if
/// that is no ellipsoid.
Eigen::VectorXd ellipsoid_start(const Points& points);

/// Finds the best ellipsoid near `start`. The points should lie at distances of about 1 from its centre.
Solution fit_ellipsoid(const Points& points, Eigen::VectorXd start);

}  // namespace sonopose::calibration::fit::detail
