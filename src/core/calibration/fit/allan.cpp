#include "calibration/fit/allan.hpp"

#include "calibration/fit/fit_support.hpp"
#include "calibration/fit/still.hpp"

#include <cmath>

namespace sonopose::calibration::fit {
namespace {

constexpr std::size_t min_samples = 1000;

/// Lengths of clusters in samples, about 20 per decade.
std::vector<std::size_t> cluster_lengths(std::size_t longest) {
  const double ratio = std::pow(10.0, 1.0 / 20.0);
  std::vector<std::size_t> lengths;
  for (double length = 1.0; length <= static_cast<double>(longest); length *= ratio) {
    const auto whole = static_cast<std::size_t>(std::lround(length));
    if (lengths.empty() || whole > lengths.back()) lengths.push_back(whole);
  }
  return lengths;
}

/// One axis of every sample: 0…2 of the gyroscope, 3…5 of the accelerometer.
std::vector<double> axis_of(std::span<const ImuSample> imu, std::size_t axis) {
  std::vector<double> values;
  values.reserve(imu.size());
  for (const ImuSample& sample : imu) {
    const Vector3d& vector = axis < 3 ? sample.angular_velocity_body_radps : sample.specific_force_body_mps2;
    values.push_back(vector[static_cast<Eigen::Index>(axis % 3)]);
  }
  return values;
}

/// Mean period. Throws if the samples are not evenly spaced.
double uniform_period_s(std::span<const ImuSample> imu) {
  constexpr double tolerance = 0.5;
  const double usual_s = usual_period_s(imu);
  for (std::size_t k = 1; k < imu.size(); ++k) {
    const double dt_s = seconds_between(imu[k - 1].sensor_time_ns, imu[k].sensor_time_ns);
    if (std::abs(dt_s - usual_s) <= tolerance * usual_s) continue;
    throw CalibrationError("sample " + std::to_string(k + 1) + " (time " +
                           std::to_string(imu[k].sensor_time_ns) + ") is " + detail::text_of(dt_s) +
                           " s after the previous one, but the usual period is " + detail::text_of(usual_s) +
                           " s ± 50 %: the Allan deviation needs samples without gaps");
  }
  return seconds_between(imu.front().sensor_time_ns, imu.back().sensor_time_ns) /
         static_cast<double>(imu.size() - 1);
}

/// Throws for motion, which would be reported as noise.
void check_rest(std::span<const ImuSample> imu) {
  constexpr double min_share = 0.9;
  std::size_t still = 0;
  for (const StillInterval& interval : find_still_intervals(imu)) still += interval.count();
  const double share = static_cast<double>(still) / static_cast<double>(imu.size());
  if (share >= min_share) return;
  throw CalibrationError("the sensor was at rest for " + detail::text_of(std::floor(100.0 * share)) +
                         " % of the recording; at least " + detail::text_of(100.0 * min_share) +
                         " % is required: place it where nothing vibrates");
}

void check_finite(std::span<const ImuSample> imu) {
  for (std::size_t k = 0; k < imu.size(); ++k) {
    if (imu[k].angular_velocity_body_radps.allFinite() && imu[k].specific_force_body_mps2.allFinite())
      continue;
    throw CalibrationError("sample " + std::to_string(k + 1) + " (time " +
                           std::to_string(imu[k].sensor_time_ns) + ") is not finite");
  }
}

}  // namespace

std::vector<AllanPoint> allan_deviation(std::span<const double> samples, double period_s) {
  constexpr std::size_t min_clusters = 9;
  const std::size_t count = samples.size();
  // Sums deviations from the mean, so that a large constant costs no digits.
  double mean = 0.0;
  for (const double sample : samples) mean += sample / static_cast<double>(count);
  std::vector<double> sums(count + 1, 0.0);
  for (std::size_t k = 0; k < count; ++k) sums[k + 1] = sums[k] + (samples[k] - mean);

  std::vector<AllanPoint> curve;
  if (count < 3 * min_clusters) return curve;
  for (const std::size_t length : cluster_lengths(count / min_clusters)) {
    const std::size_t pairs = count - 2 * length + 1;
    double squares = 0.0;
    for (std::size_t k = 0; k < pairs; ++k) {
      const double difference = sums[k + 2 * length] - 2.0 * sums[k + length] + sums[k];
      squares += difference * difference;
    }
    const auto m = static_cast<double>(length);
    const double clusters = static_cast<double>(count) / m;
    curve.push_back({.tau_s = m * period_s,
                     .deviation = std::sqrt(squares / (2.0 * m * m * static_cast<double>(pairs))),
                     .relative_error = 1.0 / std::sqrt(2.0 * (clusters - 1.0))});
  }
  return curve;
}

AllanReport analyse_allan(std::span<const ImuSample> imu) {
  if (imu.size() < min_samples) {
    throw CalibrationError(std::to_string(imu.size()) + " samples; at least " + std::to_string(min_samples) +
                           " are needed, and hours of them for the bias instability");
  }
  check_finite(imu);
  AllanReport report;
  report.period_s = uniform_period_s(imu);
  check_rest(imu);
  report.duration_s = report.period_s * static_cast<double>(imu.size());
  for (std::size_t axis = 0; axis < allan_axes.size(); ++axis) {
    report.curves[axis] = allan_deviation(axis_of(imu, axis), report.period_s);
    report.numbers[axis] = allan_numbers(report.curves[axis]);
  }
  return report;
}

}  // namespace sonopose::calibration::fit
