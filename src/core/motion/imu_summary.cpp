#include "motion/imu_summary.hpp"

#include <sonopose/geometry/rotation.hpp>
#include <sonopose/statistics/quantile.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace sonopose::motion {
namespace {

constexpr TimeNs turn_ns = 4'000'000'000;

/// Sum of squared deviations from a mean.
struct Deviation {
  void add(const Vector3d& value) {
    ++count;
    sum += value;
    squares += value.squaredNorm();
  }
  [[nodiscard]] double squared_sum() const {
    return count > 0 ? std::max(0.0, squares - sum.squaredNorm() / count) : 0.0;
  }

  double count = 0;
  Vector3d sum = Vector3d::Zero();
  double squares = 0;
};

/// Deviations within each turn of 4 s, with and without the rates.
std::pair<double, double> deviations_mps2(std::span<const Reading> imu) {
  double turned_sum = 0;
  double unturned_sum = 0;
  for (std::size_t i = 0; i < imu.size();) {
    Deviation turned;
    Deviation unturned;
    Eigen::Quaterniond q_body_to_start = Eigen::Quaterniond::Identity();
    const TimeNs start_ns = imu[i].time_ns;
    TimeNs last_ns = start_ns;
    for (; i < imu.size() && imu[i].time_ns >= last_ns && imu[i].time_ns - start_ns < turn_ns; ++i) {
      q_body_to_start =
          q_body_to_start *
          geometry::rotation_by(Vector3d(seconds_between(last_ns, imu[i].time_ns) * imu[i].rate_body_radps));
      last_ns = imu[i].time_ns;
      turned.add(q_body_to_start * imu[i].force_body_mps2);
      unturned.add(imu[i].force_body_mps2);
    }
    turned_sum += turned.squared_sum();
    unturned_sum += unturned.squared_sum();
  }
  const auto count = static_cast<double>(imu.size());
  return {std::sqrt(turned_sum / count), std::sqrt(unturned_sum / count)};
}

}  // namespace

ImuSummary summary_of(std::span<const Reading> imu) {
  ImuSummary summary;
  if (imu.empty()) return summary;
  std::vector<double> forces_mps2;
  std::vector<double> rates_radps;
  for (const Reading& reading : imu) {
    summary.mean_force_body_mps2 += reading.force_body_mps2 / static_cast<double>(imu.size());
    forces_mps2.push_back(reading.force_body_mps2.norm());
    rates_radps.push_back(reading.rate_body_radps.norm());
  }
  summary.duration_s = seconds_between(imu.front().time_ns, imu.back().time_ns);
  summary.median_force_mps2 = statistics::quantile(forces_mps2, 0.5);
  summary.force_range_mps2 =
      statistics::quantile(forces_mps2, 0.75) - statistics::quantile(forces_mps2, 0.25);
  summary.fast_rate_radps = statistics::quantile(rates_radps, 0.95);
  std::tie(summary.turned_deviation_mps2, summary.unturned_deviation_mps2) = deviations_mps2(imu);
  return summary;
}

ForceUnit force_unit_of(const ImuSummary& imu) {
  constexpr double min_mps2 = 7.0;
  constexpr double max_mps2 = 18.0;  // of a hand that shakes it
  constexpr double max_scaled_mps2 = 1.5 * standard_gravity_mps2;
  constexpr double max_range = 0.3;  // without gravity the force varies by as much as it is
  const double force_mps2 = imu.median_force_mps2;
  if (force_mps2 >= min_mps2 && force_mps2 <= max_mps2) return ForceUnit::mps2;
  const auto is_gravity_in = [force_mps2](double unit_mps2) {
    return force_mps2 * unit_mps2 >= min_mps2 && force_mps2 * unit_mps2 <= max_scaled_mps2;
  };
  if (is_gravity_in(standard_gravity_mps2) && imu.force_range_mps2 < max_range * force_mps2) {
    return ForceUnit::g;
  }
  if (is_gravity_in(1e-3 * standard_gravity_mps2)) return ForceUnit::mg;
  return force_mps2 < min_mps2 ? ForceUnit::no_gravity : ForceUnit::unknown;
}

bool has_rates_in_degrees(const ImuSummary& imu) {
  // The fastest of public recordings of a hand exceeds 15 rad/s in every twentieth sample.
  constexpr double max_radps = 20.0;
  if (imu.fast_rate_radps > max_radps) return true;
  // The force of a multicopter hardly turns with it either, but its acceleration is smaller.
  constexpr double min_radps = 2.0;
  constexpr double max_deviation_mps2 = 0.5 * standard_gravity_mps2;
  return imu.fast_rate_radps > min_radps && imu.turned_deviation_mps2 > max_deviation_mps2 &&
         imu.turned_deviation_mps2 > 2.0 * imu.unturned_deviation_mps2;
}

bool has_rates_in_millidegrees(const ImuSummary& imu) {
  constexpr double max_range_degps = 4000.0;
  return imu.fast_rate_radps > max_range_degps;
}

}  // namespace sonopose::motion
