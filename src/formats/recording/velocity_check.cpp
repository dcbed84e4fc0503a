#include "recording/velocity_check.hpp"

#include "motion/fix_faults.hpp"
#include <sonopose/statistics/quantile.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace sonopose::recording {

void VelocityCheck::add(const TwistSample& twist) {
  const std::array axes{twist_velocity_x, twist_velocity_y, twist_velocity_z};
  const std::array turns{twist_angular_velocity_x, twist_angular_velocity_y, twist_angular_velocity_z};
  Vector3d velocity_mps = Vector3d::Zero();
  Vector3d rate_radps = Vector3d::Zero();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    if ((twist.axes & axes.at(at)) != 0) velocity_mps[axis] = twist.velocity_body_mps[axis];
    if ((twist.axes & turns.at(at)) != 0) rate_radps[axis] = twist.angular_velocity_body_radps[axis];
  }
  const bool is_measured = (twist.axes & (axes[0] | axes[1] | axes[2])) != 0;
  if (is_measured && velocity_mps.allFinite()) {
    speeds_mps_.emplace_back(twist.emission_time_ns, velocity_mps.norm());
    are_horizontal_ = are_horizontal_ && (twist.axes & (twist_velocity_x | twist_velocity_y)) != 0;
  }
  if (rate_radps.allFinite()) rates_.push_back({twist.emission_time_ns, rate_radps, {}});
}

std::optional<std::string> VelocityCheck::unit(
    std::vector<motion::Position> fixes, const std::function<std::string(const char*)>& how_to_name) const {
  constexpr double min_span_s = 1.0;
  constexpr double max_span_s = 4.0;
  constexpr double min_m = 0.5;
  constexpr double max_factor = 2.0;  // slip, curves and wrong radii
  constexpr std::size_t min_spans = 5;
  constexpr std::array<std::pair<const char*, double>, 3> units{
      {{"km h^-1", 3.6}, {"cm s^-1", 100}, {"mm s^-1", 1000}}};
  motion::remove_default_position(fixes);
  std::vector<double> factors;
  std::size_t spans = 0;
  std::size_t last = 0;
  auto next = speeds_mps_.begin();
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const double span_s = seconds_between(fixes[last].time_ns, fixes[i].time_ns);
    if (span_s < min_span_s) continue;
    double sum_mps = 0;
    int count = 0;
    for (; next != speeds_mps_.end() && next->first < fixes[i].time_ns; ++next) {
      if (next->first < fixes[last].time_ns) continue;
      sum_mps += next->second;
      ++count;
    }
    const double moved_m = (fixes[i].position_world_m - fixes[last].position_world_m).norm();
    if (span_s < max_span_s && count > 0) ++spans;
    if (span_s < max_span_s && moved_m > min_m && count > 0)
      factors.push_back(sum_mps / count / (moved_m / span_s));
    last = i;
  }
  if (factors.size() < min_spans) return std::nullopt;
  const double factor = statistics::quantile(factors, 0.5);
  if (factor <= max_factor && factor * max_factor >= 1.0) return std::nullopt;
  if (factor < 1.0 && !are_horizontal_) return std::nullopt;            // few bodies rise as they drive
  if (factor < 1.0 && 2 * factors.size() < spans) return std::nullopt;  // outliers move a body that stands
  const std::string text =
      fmt::format("the velocities are {:.3g} times the speed of the fixes (median)", factor);
  for (const auto& [unit, of_unit] : units) {
    if (factor < of_unit / 1.5 || factor > 1.5 * of_unit) continue;
    return fmt::format("{}; are they in {}? {}", text, unit, how_to_name(unit));
  }
  return text + "; check their unit and axes, and the radius of the wheels";
}

std::optional<std::string> VelocityCheck::sign_of_turns(const std::vector<motion::Reading>& imu) const {
  constexpr double min_rate_radps = 0.1;
  constexpr double max_distance_s = 0.02;
  constexpr std::size_t min_turns = 50;
  constexpr double max_correlation = -0.7;
  std::size_t count = 0;
  double product = 0;
  double by_velocities = 0;
  double by_gyroscope = 0;
  auto reading = imu.begin();
  for (const motion::Reading& turn : rates_) {
    const double rate_radps = turn.rate_body_radps.norm();
    while (reading != imu.end() && reading->time_ns < turn.time_ns) ++reading;
    if (reading == imu.end()) break;
    if (rate_radps < min_rate_radps || seconds_between(turn.time_ns, reading->time_ns) > max_distance_s)
      continue;
    const double along_radps = turn.rate_body_radps.dot(reading->rate_body_radps) / rate_radps;
    product += rate_radps * along_radps;
    by_velocities += rate_radps * rate_radps;
    by_gyroscope += along_radps * along_radps;
    ++count;
  }
  const double correlation = product / std::sqrt(by_velocities * by_gyroscope);
  if (count < min_turns || !(correlation < max_correlation)) return std::nullopt;
  return fmt::format(
      "the velocities turn against the gyroscope (correlation {:.2f}): are left and right wheels swapped, or "
      "is their angular velocity clockwise?",
      correlation);
}

}  // namespace sonopose::recording
