#pragma once
/// \file
/// Measurements of a pass from the events of a log, and the choice of those that count. Private to this
/// folder.

#include "calibration/drive/likelihood.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <span>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// Calibrated samples in the order of their stamps. All finite fixes and valid headings count.
Measurements measurements_of(std::span<const Event> events, const settings::Settings& settings);

/// Restricts fixes and headings to those that the Kalman engine uses once it knows mount and delay: none of a
/// wrong or frozen track, of low quality or too late.
void judge_by_engine(std::span<const Event> events, const settings::Settings& settings,
                     const Parameters& parameters, Measurements& log);

/// Difference of consecutive gyroscope samples, as the spectral density of white noise that causes it on the
/// noisiest axis.
double gyro_scatter_radps_rthz(const Measurements& log);

/// Speed of the used fixes over spans of about half a second.
double rms_speed_mps(const std::vector<Measurements>& logs);

}  // namespace sonopose::calibration::drive::detail
