#include "calibration/drive/course.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::calibration::drive::detail {
namespace {

constexpr double half_window_s = 0.25;
constexpr std::size_t min_fixes = 4;
constexpr double min_speed_mps = 0.5;  // below it the noise of the fixes hides the course

struct Window {
  double difference_rad = 0;  ///< heading minus course
  double curvature_per_m = 0;
};

/// Velocity of a line through fixes.
Eigen::Vector2d velocity_of(std::span<const Fix* const> fixes) {
  const TimeNs origin_ns = fixes.front()->time_ns;
  double mean_s = 0;
  for (const Fix* fix : fixes) mean_s += seconds_between(origin_ns, fix->time_ns);
  mean_s /= static_cast<double>(fixes.size());
  Eigen::Vector2d moments = Eigen::Vector2d::Zero();
  double squares = 0;
  for (const Fix* fix : fixes) {
    const double time_s = seconds_between(origin_ns, fix->time_ns) - mean_s;
    moments += time_s * fix->position_world_m.head<2>();
    squares += time_s * time_s;
  }
  return moments / squares;
}

/// Mean rate about the vertical of a level body.
double yaw_rate_of(const std::vector<ImuMeasurement>& imu, TimeNs begin_ns, TimeNs end_ns) {
  const auto before = [](const ImuMeasurement& sample, TimeNs time_ns) { return sample.time_ns < time_ns; };
  double sum = 0;
  int count = 0;
  for (auto at = std::lower_bound(imu.begin(), imu.end(), begin_ns, before);
       at != imu.end() && at->time_ns <= end_ns; ++at) {
    sum += at->rate_body_radps.z();
    ++count;
  }
  return count == 0 ? 0.0 : sum / count;
}

void append_windows(const Measurements& log, std::vector<Window>& windows) {
  std::vector<const Fix*> fixes;
  for (const Fix& fix : log.fixes) {
    if (fix.used) fixes.push_back(&fix);
  }
  std::size_t begin = 0;
  std::size_t end = 0;
  for (const Heading& heading : log.headings) {
    if (!heading.used) continue;
    const TimeNs first_ns = heading.time_ns - to_ns(half_window_s);
    const TimeNs last_ns = heading.time_ns + to_ns(half_window_s);
    while (begin < fixes.size() && fixes[begin]->time_ns < first_ns) ++begin;
    end = std::max(end, begin);
    while (end < fixes.size() && fixes[end]->time_ns <= last_ns) ++end;
    if (end - begin < min_fixes) continue;
    const Eigen::Vector2d velocity = velocity_of(std::span(fixes).subspan(begin, end - begin));
    const double speed_mps = velocity.norm();
    if (speed_mps < min_speed_mps) continue;
    windows.push_back(
        {geometry::wrap_angle(heading.heading_world_rad - std::atan2(velocity.y(), velocity.x())),
         yaw_rate_of(log.imu, first_ns, last_ns) / speed_mps});
  }
}

/// Circular mean.
double mean_difference_rad(const std::vector<Window>& windows) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Window& window : windows) {
    sum += Eigen::Vector2d(std::cos(window.difference_rad), std::sin(window.difference_rad));
  }
  return std::atan2(sum.y(), sum.x());
}

}  // namespace

std::optional<CourseMount> mount_from_course(std::span<const Measurements> logs) {
  constexpr std::size_t min_windows = 100;
  constexpr int rounds = 20;
  constexpr double outlier_spreads = 2.0;
  constexpr double normal_median = 0.6745;  // median of |x| for a standard normal x
  std::vector<Window> windows;
  for (const Measurements& log : logs) append_windows(log, windows);
  if (windows.size() < min_windows) return std::nullopt;
  const double about_rad = mean_difference_rad(windows);
  double at_straight_rad = 0;
  double slope = 0;
  double spread_rad = 0;
  std::vector<double> weights(windows.size(), 1.0);
  for (int round = 0; round < rounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const Eigen::Vector2d row(1.0, windows[i].curvature_per_m);
      normal += weights[i] * row * row.transpose();
      right += weights[i] * geometry::wrap_angle(windows[i].difference_rad - about_rad) * row;
    }
    normal(1, 1) += 1e-6;  // always straight: no slope
    const Eigen::Vector2d line = normal.inverse() * right;
    at_straight_rad = line(0);
    slope = line(1);
    std::vector<double> errors;
    for (const Window& window : windows) {
      errors.push_back(std::abs(geometry::wrap_angle(window.difference_rad - about_rad) - at_straight_rad -
                                slope * window.curvature_per_m));
    }
    std::vector<double> sorted = errors;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                     sorted.end());
    spread_rad = sorted[sorted.size() / 2] / normal_median;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      weights[i] = std::min(1.0, outlier_spreads * spread_rad / std::max(errors[i], 1e-9));
    }
  }
  return CourseMount{geometry::wrap_angle(about_rad + at_straight_rad), spread_rad,
                     static_cast<int>(windows.size())};
}

}  // namespace sonopose::calibration::drive::detail
