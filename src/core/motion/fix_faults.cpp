#include "motion/fix_faults.hpp"

#include "motion/imu_summary.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/statistics/quantile.hpp>
#include <sonopose/text/number_text.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace sonopose::motion {
namespace {

constexpr std::size_t min_fixes = 10;

/// Suspects another unit if the positions accelerate more than the force on the IMU allows: usually this is
/// gravity's, so the acceleration is at most twice that. A body at rest may show whole numbers instead.
std::optional<std::string> wrong_unit_of(const std::vector<Position>& fixes) {
  constexpr TimeNs min_span_ns = 500'000'000;
  constexpr TimeNs max_span_ns = 4 * min_span_ns;
  constexpr std::size_t min_count = 10;
  constexpr double max_mps2 = 2.0 * standard_gravity_mps2;
  constexpr double min_far_m = 100.0;
  constexpr double spoilt_share = 0.75;  // default positions spoil their neighbours too
  std::vector<double> accelerations_mps2;
  std::array<std::size_t, 3> last{};  // fixes by at least a span apart, the latest at the end
  std::size_t count = 1;
  double farthest_m = 0;
  bool are_whole = true;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const Vector3d& position_m = fixes[i].position_world_m;
    farthest_m = std::max(farthest_m, position_m.cwiseAbs().maxCoeff());
    are_whole = are_whole && position_m == position_m.array().round().matrix();
    if (fixes[i].time_ns - fixes[last[2]].time_ns < min_span_ns) continue;
    last = {last[1], last[2], i};
    const TimeNs before_ns = fixes[last[1]].time_ns - fixes[last[0]].time_ns;
    const TimeNs after_ns = fixes[last[2]].time_ns - fixes[last[1]].time_ns;
    if (++count < last.size() || std::max(before_ns, after_ns) > max_span_ns) continue;
    const double before_s = seconds_between(0, before_ns);
    const double after_s = seconds_between(0, after_ns);
    const Vector3d before_mps =
        (fixes[last[1]].position_world_m - fixes[last[0]].position_world_m) / before_s;
    const Vector3d after_mps = (fixes[last[2]].position_world_m - fixes[last[1]].position_world_m) / after_s;
    const double acceleration_mps2 = 2.0 * (after_mps - before_mps).norm() / (before_s + after_s);
    if (std::isfinite(acceleration_mps2)) accelerations_mps2.push_back(acceleration_mps2);
  }
  if (accelerations_mps2.size() >= min_count) {
    const double least_mps2 = statistics::quantile(accelerations_mps2, 1.0 - spoilt_share);
    if (least_mps2 > max_mps2) {
      return "the positions accelerate by more than " + text::number_text(least_mps2, 0) +
             " m/s^2 for most of the time, which the IMU does not measure";
    }
  }
  constexpr double max_far_m = 1e9;  // in mm a thousand kilometres
  const bool is_far = farthest_m >= min_far_m && farthest_m < max_far_m;
  if (fixes.size() < min_fixes || !are_whole || !is_far) return std::nullopt;
  return "all positions are whole numbers, up to " + text::number_text(farthest_m, 0);
}

/// Fixes at one position from which the neighbours in time are far.
struct Excursions {
  std::size_t runs = 0;
  std::size_t fixes = 0;
  Vector3d first_neighbour_m = Vector3d::Zero();
  double neighbours_m = 0;  ///< from the first neighbour to the farthest one
};

struct DefaultPosition {
  Vector3d position_world_m = Vector3d::Zero();
  std::string text;
};

/// Finds a position to which the fixes jump again and again, while those between move.
std::optional<DefaultPosition> default_position_in(const std::vector<Position>& fixes) {
  constexpr std::size_t min_default = 4;
  constexpr std::size_t min_runs = 2;
  constexpr double far_m = 0.5;
  constexpr double min_moved_m = 1.0;
  std::map<std::array<double, 3>, Excursions> excursions_by_place;
  for (std::size_t begin = 0; begin < fixes.size();) {
    const Vector3d& at_m = fixes[begin].position_world_m;
    std::size_t end = begin + 1;
    while (end < fixes.size() && fixes[end].position_world_m == at_m) ++end;
    const std::size_t first = std::exchange(begin, end);
    if (first == 0 || end == fixes.size()) continue;
    const Vector3d& before_m = fixes[first - 1].position_world_m;
    const Vector3d& after_m = fixes[end].position_world_m;
    const double limit_m = 2.0 * (after_m - before_m).norm() + far_m;
    if ((at_m - before_m).norm() < limit_m || (at_m - after_m).norm() < limit_m) continue;
    Excursions& all = excursions_by_place[{at_m.x(), at_m.y(), at_m.z()}];
    if (all.runs++ == 0) all.first_neighbour_m = before_m;
    all.neighbours_m = std::max(all.neighbours_m, (before_m - all.first_neighbour_m).norm());
    all.fixes += end - first;
  }
  for (const auto& [place_m, all] : excursions_by_place) {
    // At rest, a reflection may repeat, but not at the origin.
    const bool is_origin = place_m == std::array<double, 3>{};
    if (all.fixes < min_default || all.runs < min_runs) continue;
    if (!is_origin && all.neighbours_m < min_moved_m) continue;
    std::string found = std::to_string(all.fixes) + " of " + std::to_string(fixes.size()) + " fixes are";
    for (const double coordinate_m : place_m) found += ' ' + text::number_text(coordinate_m, 2);
    return DefaultPosition{{place_m[0], place_m[1], place_m[2]}, found + " m, a default position"};
  }
  return std::nullopt;
}

/// True if the IMU accelerates between two times.
bool accelerates(std::span<const Reading> imu, TimeNs from_ns, TimeNs to_ns) {
  constexpr double min_acceleration_mps2 = 0.2;
  const auto is_before = [](const Reading& reading, TimeNs time_ns) { return reading.time_ns < time_ns; };
  const auto from = std::lower_bound(imu.begin(), imu.end(), from_ns, is_before);
  const auto to = std::lower_bound(from, imu.end(), to_ns, is_before);
  return summary_of({from, to}).turned_deviation_mps2 >= min_acceleration_mps2;
}

/// True if a tag that rounds its positions explains repetitions: most of its steps are to the next value.
bool are_rounded(const std::vector<Position>& fixes) {
  constexpr double tolerance = 0.02;  // of a step, for inexact decimals
  constexpr std::size_t min_steps = 4;
  constexpr double unknown_m = std::numeric_limits<double>::infinity();
  Vector3d resolution_m = Vector3d::Constant(unknown_m);
  std::vector<Vector3d> steps_m;
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const Vector3d step_m = (fixes[i].position_world_m - fixes[i - 1].position_world_m).cwiseAbs();
    if (step_m.isZero(0.0)) continue;
    steps_m.push_back(step_m);
    resolution_m = resolution_m.cwiseMin((step_m.array() > 0.0).select(step_m, unknown_m));
  }
  std::size_t to_next = 0;
  for (const Vector3d& step_m : steps_m) {
    const Eigen::Array3d count = step_m.cwiseQuotient(resolution_m);
    if (((count - count.round()).abs() > tolerance).any()) return false;
    if (count.maxCoeff() < 1.0 + tolerance) ++to_next;
  }
  return steps_m.size() >= min_steps && 2 * to_next > steps_m.size();
}

/// Finds a driver that sends its last position again, or beacons that do, while the IMU accelerates. At rest
/// positions may be equal.
std::optional<FixFault> repetitions_in(const Window& window) {
  constexpr TimeNs min_rest_ns = 1'000'000'000;
  constexpr TimeNs margin_ns = 200'000'000;  // the fixes may be late by this
  const std::vector<Position>& fixes = window.fixes;
  std::size_t judged = 0;
  std::size_t repeated = 0;
  std::size_t longest_run = 0;
  for (std::size_t begin = 0; begin < fixes.size();) {
    std::size_t end = begin + 1;
    while (end < fixes.size() && fixes[end].position_world_m == fixes[begin].position_world_m) ++end;
    const TimeNs from_ns = fixes[begin].time_ns;
    const TimeNs to_ns = fixes[end - 1].time_ns;
    const std::size_t run = end - std::exchange(begin, end);
    if (to_ns - from_ns >= min_rest_ns && !accelerates(window.imu, from_ns + margin_ns, to_ns - margin_ns)) {
      continue;
    }
    judged += run;
    repeated += run - 1;
    longest_run = std::max(longest_run, run);
  }
  constexpr std::size_t longest_share = 4;  // of the window, of which each position is a small part
  const bool is_frozen = longest_share * longest_run > judged;
  if (window.imu.empty() || judged < min_fixes || 2 * repeated <= judged) return std::nullopt;
  if (!is_frozen && are_rounded(fixes)) return std::nullopt;
  if (!accelerates(window.imu, window.imu.front().time_ns, window.imu.back().time_ns)) return std::nullopt;
  return FixFault{is_frozen ? FixFaultKind::frozen : FixFaultKind::repeated,
                  std::to_string(repeated) + " of " + std::to_string(fixes.size()) +
                      " fixes repeat the position of the one before, although the IMU moves"};
}

/// Finds headings that are constant, or small as in radians, while the gyroscope turns.
std::optional<FixFault> heading_fault_of(const Window& window, const TurnGain& turn) {
  constexpr double fast_turn_radps = 0.5;
  constexpr double max_angle_in_radians = 6.3;  // read as degrees
  constexpr double resolution_rad = 0.01 * geometry::radians_per_degree;
  const std::vector<Direction>& headings = window.headings;
  if (headings.size() < min_fixes || turn.gyro_radps <= fast_turn_radps) return std::nullopt;
  // Headings of a small part of the window need not be those of the turn.
  const TimeNs imu_ns = window.imu.back().time_ns - window.imu.front().time_ns;
  if (headings.back().time_ns - headings.front().time_ns < imu_ns / 2) return std::nullopt;
  const double first_rad = headings.front().heading_world_rad;
  const auto are_within = [&](double limit_rad, double centre_rad) {
    return std::all_of(headings.begin(), headings.end(), [=](const Direction& heading) {
      return std::abs(geometry::wrap_angle(heading.heading_world_rad - centre_rad)) < limit_rad;
    });
  };
  if (are_within(resolution_rad, first_rad)) {
    return FixFault{FixFaultKind::headings_constant, "all headings are equal although the gyroscope turns"};
  }
  if (!are_within(max_angle_in_radians * geometry::radians_per_degree, window.heading_zero_rad))
    return std::nullopt;
  return FixFault{FixFaultKind::headings_in_radians,
                  "all headings are below 6.3 deg although the gyroscope turns"};
}

}  // namespace

std::optional<std::string> remove_default_position(std::vector<Position>& fixes) {
  auto found = default_position_in(fixes);
  if (!found) return std::nullopt;
  std::erase_if(fixes, [&](const Position& fix) { return fix.position_world_m == found->position_world_m; });
  return std::move(found->text);
}

std::vector<FixFault> fix_faults_of(const Window& window, const TurnGain& turn) {
  std::vector<FixFault> faults;
  std::vector<Position> fixes = window.fixes;  // jumps to a default position look like another unit
  if (auto text = remove_default_position(fixes)) {
    faults.push_back({FixFaultKind::default_position, *std::move(text)});
  }
  if (auto found = wrong_unit_of(fixes)) faults.push_back({FixFaultKind::unit, *std::move(found)});
  if (auto found = repetitions_in(window)) faults.push_back(*std::move(found));
  if (auto found = heading_fault_of(window, turn)) faults.push_back(*std::move(found));
  return faults;
}

bool are_moving(const std::vector<Position>& fixes) {
  constexpr double spoilt_share = 0.1;  // at either end, by outliers
  constexpr double min_moved_m = 1.0;
  if (fixes.empty()) return false;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values_m;
    for (const Position& fix : fixes) values_m.push_back(fix.position_world_m(axis));
    if (statistics::quantile(values_m, 1.0 - spoilt_share) - statistics::quantile(values_m, spoilt_share) >
        min_moved_m) {
      return true;
    }
  }
  return false;
}

}  // namespace sonopose::motion
