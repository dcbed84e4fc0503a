#pragma once
/// \file
/// Means of the IMU while its beacon is at rest.

#include "doctor/probe/latest.hpp"
#include "doctor/rules/observations.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::doctor::probe {

/// Means over the longest rest, in blocks of about a second, with the calibration applied. The readings
/// spread by less than 0.25 m/s² and 0.03 rad/s on each axis, within each block and over all of them. The
/// medians of the blocks' fixes lie within 0.25 m. Empty if fewer than three blocks rest, unless a shorter
/// window rests completely.
std::optional<rules::RestObservation> longest_rest(const Latest<ImuSample>& readings,
                                                   const Latest<UltrasonicFix>& fixes,
                                                   const calibration::Settings& calibration);

}  // namespace sonopose::doctor::probe
