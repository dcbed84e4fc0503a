#pragma once
/// \file
/// Mount, delay, lever arm and noise from recordings of a moving vehicle, without truth: the values that make
/// the innovations of a Kalman filter most probable.

#include "calibration/fit/error.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::calibration::drive {

using fit::CalibrationError;

/// Quantities of an installation that a drive shows.
enum class Quantity {
  mount,           ///< rad: from body X to the axis of the pair
  delay,           ///< s: age of fixes and headings beyond their stamps
  lever_arm_x,     ///< m: from the tracked point to the IMU, body
  lever_arm_y,     ///< m
  lever_arm_z,     ///< m
  fix_horizontal,  ///< m: standard deviation of a fix per axis
  fix_vertical,    ///< m
  heading,         ///< rad: standard deviation of a heading
  accel,           ///< m/s²/√Hz: spectral density of the accelerometer's noise
  gyro             ///< rad/s/√Hz
};
inline constexpr std::size_t quantity_count = 10;

constexpr std::array<std::string_view, quantity_count> choices_of(Quantity /*unused*/) {
  return {"mount",          "delay",        "lever_arm_x", "lever_arm_y", "lever_arm_z",
          "fix_horizontal", "fix_vertical", "heading",     "accel",       "gyro"};
}

struct Value {
  double value = 0;
  double low = 0;  ///< lower end of the interval that contains the truth in 19 of 20 recordings
  double high = 0;
  /// Motion or data that the recording lacks for a value; empty if there is one.
  std::string missing;

  [[nodiscard]] bool is_known() const { return missing.empty(); }
};

/// Method by which the mount was found.
enum class MountMethod {
  likelihood,  ///< from the innovations, like everything else
  course       ///< from the direction of travel, because the IMU contradicts the fixes
};

/// One point of the likelihood along a quantity, with all others at their most probable values.
struct CurvePoint {
  double value = 0;
  double log_likelihood = 0;  ///< log-likelihood minus that of the maximum
};

/// Half of an interval in standard deviations: 95 % of a normal distribution.
inline constexpr double interval_stds = 1.96;

struct DriveFit {
  std::array<Value, quantity_count> values;
  MountMethod mount_method = MountMethod::likelihood;
  std::string why_course;  ///< reason for MountMethod::course
  bool converged = false;
  double stamped_delay_s = 0;         ///< mean of receipt minus stamp over the fixes
  double stamped_delay_spread_s = 0;  ///< standard deviation of receipt minus stamp
  std::size_t fixes = 0;
  std::size_t fixes_used = 0;
  std::size_t headings = 0;
  std::size_t headings_used = 0;
  std::size_t imu_silences = 0;  ///< silences of the IMU, at which the recordings are cut
  double used_s = 0;             ///< duration of the pieces in between that are long enough
  /// Reason why the fusion cannot correct the delay that was found, and what to do; empty if it can.
  std::string clock_fault;
  double squared_fix_innovation = 0;      ///< normalised, mean per degree of freedom; 1 if the noise is right
  double squared_heading_innovation = 0;  ///< normalised, mean per degree of freedom; 1 if the noise is right
  std::array<std::vector<CurvePoint>, quantity_count>
      curves;  ///< empty for the lever arm, and unless requested

  [[nodiscard]] const Value& operator[](Quantity quantity) const {
    return values[static_cast<std::size_t>(quantity)];
  }
  [[nodiscard]] Value& operator[](Quantity quantity) { return values[static_cast<std::size_t>(quantity)]; }
};

struct DriveOptions {
  bool curves = false;
  std::function<void(std::string_view stage, int step)> on_progress;  ///< may be empty
};

/// Calibrates one installation from recordings, each a list of events in the order of arrival, with the
/// settings of the fusion (calibration of the IMU, admission). Cuts them at silences of the IMU. Finds delays
/// of up to 3 s. Throws CalibrationError if there are too few samples or fixes.
DriveFit calibrate_drive(std::span<const std::vector<Event>> recordings, const settings::Settings& settings,
                         const DriveOptions& options = {});

}  // namespace sonopose::calibration::drive
