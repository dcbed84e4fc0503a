#include "calibration/fit/still.hpp"

#include <sonopose/statistics/quantile.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::calibration::fit {
namespace {

using statistics::quantile;

// Thresholds for stillness. The noise of the recording sets them: that of its calmest windows, times a
// factor, but never less than what a quantised sensor shows nor more than what a hand does.
constexpr double window_s = 0.6;  // the spread is taken over windows of this length
constexpr double min_s = 1.0;     // shorter periods do not count
constexpr double noise_factor = 4.0;
constexpr double min_gyro_radps = 0.005;
constexpr double max_gyro_radps = 0.06;
constexpr double min_accel_mps2 = 0.04;
constexpr double max_accel_mps2 = 0.4;
/// Largest difference of a window's mean rate from the usual one: a steady slow turn is not still.
constexpr double rate_tolerance_radps = 0.02;

/// Mean and spread (root of the summed variances of three axes) of a run of samples.
struct Moments {
  Vector3d mean_rate_radps = Vector3d::Zero();
  Vector3d mean_force_mps2 = Vector3d::Zero();
  double rate_spread_radps = 0;
  double force_spread_mps2 = 0;
};

Moments moments_of(std::span<const ImuSample> imu) {
  Moments found;
  const auto count = static_cast<double>(imu.size());
  for (const ImuSample& sample : imu) {
    found.mean_rate_radps += sample.angular_velocity_body_radps / count;
    found.mean_force_mps2 += sample.specific_force_body_mps2 / count;
  }
  double rate_variance = 0.0;
  double force_variance = 0.0;
  for (const ImuSample& sample : imu) {
    rate_variance += (sample.angular_velocity_body_radps - found.mean_rate_radps).squaredNorm() / count;
    force_variance += (sample.specific_force_body_mps2 - found.mean_force_mps2).squaredNorm() / count;
  }
  found.rate_spread_radps = std::sqrt(rate_variance);
  found.force_spread_mps2 = std::sqrt(force_variance);
  return found;
}

/// The recording in blocks of a third of a window. A block is assessed together with its two neighbours, so
/// that the blocks next to a motion are excluded.
class Blocks {
public:
  explicit Blocks(std::span<const ImuSample> imu) : imu_(imu), period_s_(usual_period_s(imu)) {
    size_ = std::max<std::size_t>(
        2, period_s_ > 0.0 ? static_cast<std::size_t>(std::lround(window_s / 3.0 / period_s_)) : 2);
    for (std::size_t begin = 0; begin + 3 * size_ <= imu.size(); begin += size_) {
      windows_.push_back(moments_of(imu.subspan(begin, 3 * size_)));
    }
  }

  /// Runs of blocks in the middle of still windows, as ranges of samples.
  [[nodiscard]] std::vector<StillInterval> still() const {
    const std::vector<bool> calm = calm_windows();
    std::vector<StillInterval> found;
    for (std::size_t window = 0; window < calm.size(); ++window) {
      if (!calm[window]) continue;
      const std::size_t begin = (window + 1) * size_;
      const bool goes_on = !found.empty() && found.back().end == begin;
      if (!goes_on) found.push_back({.begin = begin});
      found.back().end = begin + size_;
    }
    std::erase_if(found, [this](const StillInterval& interval) {
      return static_cast<double>(interval.count()) * period_s_ < min_s;
    });
    return found;
  }

private:
  [[nodiscard]] bool has_gap(std::size_t begin, std::size_t end) const {
    constexpr double max_gap_periods = 5.0;
    for (std::size_t k = begin + 1; k < end; ++k) {
      const double dt_s = seconds_between(imu_[k - 1].sensor_time_ns, imu_[k].sensor_time_ns);
      if (!(dt_s > 0.0 && dt_s <= max_gap_periods * period_s_)) return true;
    }
    return false;
  }

  [[nodiscard]] std::vector<bool> calm_windows() const {
    const double rate_limit_radps =
        std::clamp(noise_factor * floor_of(&Moments::rate_spread_radps), min_gyro_radps, max_gyro_radps);
    const double force_limit_mps2 =
        std::clamp(noise_factor * floor_of(&Moments::force_spread_mps2), min_accel_mps2, max_accel_mps2);
    std::vector<bool> calm(windows_.size());
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      // Written so that a NaN is not calm.
      calm[i] = windows_[i].rate_spread_radps <= rate_limit_radps &&
                windows_[i].force_spread_mps2 <= force_limit_mps2 && !has_gap(i * size_, (i + 3) * size_);
    }
    const Vector3d usual_radps = usual_rate(calm);
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      const double off_radps = (windows_[i].mean_rate_radps - usual_radps).norm();
      calm[i] = calm[i] && off_radps <= rate_tolerance_radps;
    }
    return calm;
  }

  /// Spread of the calmest windows: rest, if there is any.
  [[nodiscard]] double floor_of(double Moments::*spread) const {
    constexpr double share = 0.05;
    std::vector<double> spreads;
    for (const Moments& window : windows_) spreads.push_back(window.*spread);
    return quantile(std::move(spreads), share);
  }

  /// Median of the calm windows' mean rates: the gyroscope's offset, unless it was turning most of the time.
  [[nodiscard]] Vector3d usual_rate(const std::vector<bool>& calm) const {
    Vector3d usual_radps = Vector3d::Zero();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      std::vector<double> rates;
      for (std::size_t i = 0; i < windows_.size(); ++i) {
        if (calm[i]) rates.push_back(windows_[i].mean_rate_radps[axis]);
      }
      usual_radps[axis] = quantile(std::move(rates), 0.5);
    }
    return usual_radps;
  }

  std::span<const ImuSample> imu_;
  double period_s_;
  std::size_t size_ = 2;
  std::vector<Moments> windows_;  ///< window i holds blocks i, i + 1 and i + 2
};

}  // namespace

double usual_period_s(std::span<const ImuSample> imu) {
  if (imu.size() < 2) return 0.0;
  std::vector<double> periods_s;
  periods_s.reserve(imu.size() - 1);
  for (std::size_t k = 1; k < imu.size(); ++k) {
    periods_s.push_back(seconds_between(imu[k - 1].sensor_time_ns, imu[k].sensor_time_ns));
  }
  return quantile(std::move(periods_s), 0.5);
}

std::vector<StillInterval> find_still_intervals(std::span<const ImuSample> imu) {
  std::vector<StillInterval> intervals = Blocks(imu).still();
  for (StillInterval& interval : intervals) {
    const Moments moments = moments_of(imu.subspan(interval.begin, interval.count()));
    interval.mean_rate_radps = moments.mean_rate_radps;
    interval.mean_force_mps2 = moments.mean_force_mps2;
    const double root_of_count =
        std::sqrt(3.0 * static_cast<double>(interval.count()));  // spreads are of 3 axes
    interval.rate_error_radps = moments.rate_spread_radps / root_of_count;
    interval.force_error_mps2 = moments.force_spread_mps2 / root_of_count;
  }
  return intervals;
}

std::size_t count_orientations(std::span<const StillInterval> intervals, double min_angle_rad) {
  std::vector<Vector3d> seen;
  for (const StillInterval& interval : intervals) {
    const Vector3d direction = interval.mean_force_mps2.normalized();
    const bool is_new = std::none_of(seen.begin(), seen.end(), [&](const Vector3d& other) {
      return std::atan2(direction.cross(other).norm(), direction.dot(other)) < min_angle_rad;
    });
    if (is_new) seen.push_back(direction);
  }
  return seen.size();
}

}  // namespace sonopose::calibration::fit
