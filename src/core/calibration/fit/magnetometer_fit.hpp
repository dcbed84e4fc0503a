#pragma once
/// \file
/// Hard and soft iron from a recording of a sensor turned through all directions. The readings of a field of
/// constant strength lie on an ellipsoid, which the calibration makes a sphere about zero.

#include "calibration/fit/error.hpp"
#include <sonopose/calibration/model/magnetometer.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <optional>
#include <span>

namespace sonopose::calibration::fit {

struct MagnetometerFit {
  MagnetometerSettings settings;
  MagnetometerSettings standard_errors;  ///< standard error of each setting
  std::size_t samples = 0;               ///< samples with a field
  std::size_t used = 0;                  ///< samples in the fit: no direction counts more than another
  std::size_t outliers = 0;              ///< samples left out of the fit: glitches and disturbed fields
  double coverage = 0;                   ///< share of the sphere's directions that were seen, 0…1
  double field_ut = 0;                   ///< strength of the corrected field
  Vector3d centre_ut = Vector3d::Zero();
  Vector3d semi_axes_ut = Vector3d::Zero();  ///< semi-axes of the ellipsoid, longest first
  double rms_before_ut = 0;                  ///< RMS of |field| − its own mean, over the used samples
  double rms_after_ut = 0;                   ///< RMS of |corrected field| − field_ut
};

/// Minimises the readings' distances from the ellipsoid |S·m − h| = F, with S symmetric and positive. F is
/// `field_ut`. Without it, F keeps the ellipsoid's volume (det S = 1): the strength of the raw readings about
/// their centre. Throws CalibrationError for too few samples, directions that do not determine the ellipsoid
/// (such as all in one plane), readings that lie on none, and values that no setting allows.
MagnetometerFit fit_magnetometer(std::span<const ImuSample> imu, std::optional<double> field_ut = {});

}  // namespace sonopose::calibration::fit
