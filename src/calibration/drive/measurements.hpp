#pragma once
/// \file
/// From the events of a log to the measurements of a pass, and which of them count. Private to this folder.

#include "calibration/drive/likelihood.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <span>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// The calibrated samples in the order of their stamps. All finite fixes and valid headings count.
Measurements measurements_of(std::span<const Event> events, const settings::Settings& settings);

/// Lets only those fixes and headings count that the Kalman engine uses when it knows mount and delay: none
/// of a wrong or frozen track, of low quality or too late.
void judge_by_engine(std::span<const Event> events, const settings::Settings& settings,
                     const Parameters& parameters, Measurements& log);

/// By how much consecutive samples of the gyroscope differ, as the spectral density of white noise that makes
/// such differences on the noisiest axis.
double gyro_scatter_radps_rthz(const Measurements& log);

/// The speed of the used fixes over spans of about half a second.
double rms_speed_mps(const std::vector<Measurements>& logs);

}  // namespace sonopose::calibration::drive::detail
