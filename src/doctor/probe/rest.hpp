#pragma once
/// \file
/// The means of the IMU while its beacon is at rest.

#include "doctor/probe/latest.hpp"
#include "doctor/rules/observations.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::doctor::probe {

/// The means of the longest time at rest, in blocks of about a second, with the calibration applied. In each
/// of its blocks the readings spread by less than 0.25 m/s² and 0.03 rad/s on each axis; so do those of all
/// of them, and the medians of their fixes lie within 0.25 m. Empty if fewer than three blocks rest, or
/// not all of a shorter window.
std::optional<rules::RestObservation> longest_rest(const Latest<ImuSample>& readings,
                                                   const Latest<UltrasonicFix>& fixes,
                                                   const calibration::Settings& calibration);

}  // namespace sonopose::doctor::probe
