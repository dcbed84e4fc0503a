#include "evaluation/calibration/calibration.hpp"

#include "bus_log/sensor_log.hpp"
#include "recording/log_folder.hpp"

namespace sonopose::evaluation {
namespace {

namespace fs = std::filesystem;
using calibration::fit::CalibrationError;

CalibrationResult summary_of(const fs::path& log, const std::vector<ImuSample>& imu) {
  CalibrationResult result;
  result.log = log;
  result.samples = imu.size();
  if (imu.empty()) throw CalibrationError("no samples");
  result.begin_ns = imu.front().sensor_time_ns;
  result.duration_s = seconds_between(imu.front().sensor_time_ns, imu.back().sensor_time_ns);
  return result;
}

void find_still(const std::vector<ImuSample>& imu, CalibrationResult& result) {
  result.still = calibration::fit::find_still_intervals(imu);
  for (const auto& interval : result.still) {
    result.still_begin_ns.push_back(imu[interval.begin].sensor_time_ns);
  }
}

/// Adds the file name to a CalibrationError of `work`.
template <class Work>
CalibrationResult from_log(const fs::path& log, std::optional<BeaconAddress> beacon, const Work& work) {
  const auto imu = bus_log::read_imu_log(log, beacon);
  try {
    CalibrationResult result = summary_of(log, imu);
    work(imu, result);
    return result;
  } catch (const CalibrationError& error) {
    throw CalibrationError(bus_log::imu_source(log).string() + ": " + error.what());
  }
}

}  // namespace

CalibrationResult calibrate_imu(const fs::path& log, std::optional<BeaconAddress> beacon) {
  return from_log(log, beacon, [](const std::vector<ImuSample>& imu, CalibrationResult& result) {
    find_still(imu, result);
    result.accelerometer = calibration::fit::fit_accelerometer(result.still);
    result.gyroscope = calibration::fit::fit_gyroscope(imu, result.still, result.accelerometer->settings);
  });
}

CalibrationResult calibrate_gyroscope(const fs::path& log, std::optional<BeaconAddress> beacon) {
  return from_log(log, beacon, [](const std::vector<ImuSample>& imu, CalibrationResult& result) {
    find_still(imu, result);
    result.gyroscope = calibration::fit::fit_gyroscope(result.still);
  });
}

CalibrationResult calibrate_magnetometer(const fs::path& log, std::optional<double> field_ut,
                                         std::optional<BeaconAddress> beacon) {
  return from_log(log, beacon, [field_ut](const std::vector<ImuSample>& imu, CalibrationResult& result) {
    result.magnetometer = calibration::fit::fit_magnetometer(imu, field_ut);
  });
}

}  // namespace sonopose::evaluation
