#include "motion/turn_gain.hpp"

#include "motion/imu_summary.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/statistics/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace sonopose::motion {
namespace {

constexpr double max_imu_gap_s = 0.12;
constexpr double max_course_gap_s = 0.6;

/// A direction, continuous beyond ±π.
struct CoursePoint {
  TimeNs time_ns = 0;
  double direction_rad = 0;
};
using Course = std::vector<CoursePoint>;

void add(Course& course, TimeNs time_ns, double angle_rad) {
  const double before_rad = course.empty() ? angle_rad : course.back().direction_rad;
  course.push_back({time_ns, before_rad + geometry::wrap_angle(angle_rad - before_rad)});
}

/// Directions of travel, where the fixes move.
Course travel_of(const std::vector<Position>& fixes) {
  constexpr double step_s = 0.4;
  constexpr double min_step_m = 0.2;  // well above the noise of fixes
  Course course;
  std::size_t end = 0;
  for (const Position& from : fixes) {
    while (end < fixes.size() && seconds_between(from.time_ns, fixes[end].time_ns) < step_s) ++end;
    if (end == fixes.size()) break;
    const Vector3d moved_m = fixes[end].position_world_m - from.position_world_m;
    if (moved_m.head<2>().norm() < min_step_m) continue;
    add(course, from.time_ns + (fixes[end].time_ns - from.time_ns) / 2, std::atan2(moved_m.y(), moved_m.x()));
  }
  return course;
}

/// End of the turn that begins here; empty if it is small or takes longer, or jumps as outliers do.
std::optional<std::size_t> end_of_turn(const Course& course, std::size_t begin, double max_s) {
  constexpr double min_s = 0.5;
  constexpr double min_turn_rad = 30.0 * geometry::radians_per_degree;
  constexpr double max_bend = 0.35;  // a quarter where the rate grows from zero, a half for a jump
  std::size_t middle = begin;
  for (std::size_t end = begin + 1; end < course.size(); ++end) {
    const double length_s = seconds_between(course[begin].time_ns, course[end].time_ns);
    if (length_s > max_s) break;
    if (seconds_between(course[end - 1].time_ns, course[end].time_ns) > max_course_gap_s) break;
    while (2 * (course[middle].time_ns - course[begin].time_ns) < course[end].time_ns - course[begin].time_ns)
      ++middle;
    const double turn_rad = course[end].direction_rad - course[begin].direction_rad;
    if (length_s < min_s || std::abs(turn_rad) < min_turn_rad) continue;
    const double share = seconds_between(course[begin].time_ns, course[middle].time_ns) / length_s;
    const double bend_rad = course[middle].direction_rad - course[begin].direction_rad - share * turn_rad;
    return std::abs(bend_rad) < max_bend * std::abs(turn_rad) ? std::optional(end) : std::nullopt;
  }
  return std::nullopt;
}

/// Integral of the rates, in body axes; empty over a gap.
std::optional<Vector3d> gyro_turn_rad(const std::vector<Reading>& imu, TimeNs begin_ns, TimeNs end_ns) {
  auto reading = std::upper_bound(imu.begin(), imu.end(), begin_ns,
                                  [](TimeNs time_ns, const Reading& each) { return time_ns < each.time_ns; });
  Vector3d turn_rad = Vector3d::Zero();
  for (TimeNs last_ns = begin_ns; last_ns < end_ns; ++reading) {
    if (reading == imu.end()) return std::nullopt;
    if (seconds_between(last_ns, reading->time_ns) > max_imu_gap_s) return std::nullopt;
    turn_rad += seconds_between(last_ns, std::min(reading->time_ns, end_ns)) * reading->rate_body_radps;
    last_ns = reading->time_ns;
  }
  return turn_rad;
}

/// Turns by the gyroscope over those of the course, in body axes.
std::vector<Vector3d> gains_of(const Course& course, const std::vector<Reading>& imu, double max_s,
                               TurnGain& all) {
  std::vector<Vector3d> gains;
  for (std::size_t begin = 0; begin < course.size();) {
    const auto end = end_of_turn(course, begin, max_s);
    const auto by_gyro_rad =
        end ? gyro_turn_rad(imu, course[begin].time_ns, course[*end].time_ns) : std::nullopt;
    if (by_gyro_rad) {
      const double turn_rad = course[*end].direction_rad - course[begin].direction_rad;
      gains.emplace_back(*by_gyro_rad / turn_rad);
      const double length_s = seconds_between(course[begin].time_ns, course[*end].time_ns);
      all.compared_radps = std::max(all.compared_radps, std::abs(turn_rad) / length_s);
    }
    begin = end.value_or(begin + 1);
  }
  return gains;
}

/// Fastest mean rate about this axis over a second.
double fastest_second_radps(const std::vector<Reading>& imu, const Vector3d& axis) {
  constexpr TimeNs second_ns = 1'000'000'000;
  double fastest_radps = 0;
  if (imu.empty()) return fastest_radps;
  for (TimeNs begin_ns = imu.front().time_ns; begin_ns + second_ns <= imu.back().time_ns;
       begin_ns += second_ns) {
    const auto turn_rad = gyro_turn_rad(imu, begin_ns, begin_ns + second_ns);
    if (turn_rad) fastest_radps = std::max(fastest_radps, std::abs(axis.dot(*turn_rad)));
  }
  return fastest_radps;
}

}  // namespace

TurnGain turn_gain_of(Window window) {
  sort_by_time(window);
  TurnGain all;
  all.by_heading = !window.headings.empty();
  Course course;
  for (const Direction& heading : window.headings) add(course, heading.time_ns, heading.heading_world_rad);
  if (!all.by_heading) course = travel_of(window.fixes);
  constexpr double fast_s = 2.0;
  constexpr double slow_s = 8.0;  // then a usual offset of the rate does not change the sign
  constexpr std::size_t min_turns = 2;
  std::vector<Vector3d> gains = gains_of(course, window.imu, fast_s, all);
  if (gains.size() < min_turns && all.by_heading) {
    all.is_slow = true;
    gains = gains_of(course, window.imu, slow_s, all);
  }
  all.turns = gains.size();
  const auto quantile_along = [&gains](const Vector3d& axis, double share) {
    std::vector<double> values;
    for (const Vector3d& gain : gains) values.push_back(axis.dot(gain));
    return statistics::quantile(std::move(values), share);
  };
  const Vector3d median(quantile_along(Vector3d::UnitX(), 0.5), quantile_along(Vector3d::UnitY(), 0.5),
                        quantile_along(Vector3d::UnitZ(), 0.5));
  Vector3d force_mps2 = Vector3d::Zero();
  for (const Reading& reading : window.imu) force_mps2 += reading.force_body_mps2;
  const ForceUnit unit = force_unit_of(summary_of(window.imu));
  if (unit == ForceUnit::no_gravity || unit == ForceUnit::unknown) all.turns = 0;  // no vertical is known
  const Vector3d axis = median.dot(force_mps2) < 0 ? -median.normalized() : median.normalized();
  all.gyro_radps = fastest_second_radps(window.imu, force_mps2.normalized());
  all.gain = quantile_along(axis, 0.5);
  all.spread = quantile_along(axis, 0.75) - quantile_along(axis, 0.25);
  return all;
}

TurnFault turn_fault_of(const TurnGain& turn) {
  constexpr std::size_t min_turns = 2;
  constexpr std::size_t min_turns_of_travel = 4;
  constexpr double max_spread = 0.4;  // in units of the gain
  constexpr double degrees_gain = 20.0;
  constexpr double dead_gain = 0.3;
  constexpr double inverted_gain = -0.6;
  constexpr double wrong_scale = 1.4;
  const double size = std::abs(turn.gain);
  if (turn.turns < (turn.by_heading ? min_turns : min_turns_of_travel)) return TurnFault::none;
  if (turn.spread > max_spread * std::max(1.0, size)) return TurnFault::none;
  if (turn.gain < inverted_gain && size < degrees_gain) return TurnFault::wrong_sign;
  if (!turn.by_heading || turn.is_slow) return TurnFault::none;
  if (size > degrees_gain) return TurnFault::degrees;
  if (turn.turns <= min_turns) return TurnFault::none;
  if (size < dead_gain) {
    // An axis that senses turns at other times is not dead: its clock is another.
    return turn.gyro_radps < dead_gain * turn.compared_radps ? TurnFault::dead : TurnFault::none;
  }
  return size > wrong_scale || size < 1.0 / wrong_scale ? TurnFault::scale : TurnFault::none;
}

}  // namespace sonopose::motion
