#pragma once
/// \file
/// Measurements of a pass from the events of a log, and the choice of those that count. Private to this
/// folder.

#include "calibration/drive/likelihood.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <set>
#include <span>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// Calibrated samples in the order of their stamps. All finite fixes and valid headings count.
Measurements measurements_of(std::span<const Event> events, const settings::Settings& settings);

/// Event numbers of the fixes and headings that the Kalman engine uses once it knows mount and delay: none of
/// a wrong or frozen track, of low quality or too late.
std::set<std::uint64_t> used_by_engine(std::span<const Event> events, const settings::Settings& settings,
                                       double mount_rad, double delay_s);

/// The events with the stamps of fixes and headings set back by a delay, and their receipt too, but not
/// before the stamp; in the order in which they are then available.
std::vector<Event> set_back(std::vector<Event> events, double delay_s);

/// Difference of consecutive samples of a sensor, as the spectral density of white noise that causes it on
/// the noisiest axis: in the sensor's unit per √Hz, the largest of all logs.
double scatter_rthz(const std::vector<Measurements>& logs, Vector3d ImuMeasurement::*sensor);

/// Speed of the used fixes over spans of about half a second.
double rms_speed_mps(const std::vector<Measurements>& logs);

}  // namespace sonopose::calibration::drive::detail
