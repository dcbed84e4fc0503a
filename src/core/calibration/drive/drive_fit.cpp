#include "calibration/drive/drive_fit.hpp"

#include "calibration/drive/course.hpp"
#include "calibration/drive/measurements.hpp"
#include "calibration/drive/scoring.hpp"
#include "calibration/drive/start.hpp"
#include "calibration/drive/values.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::calibration::drive {
namespace {

using detail::Fit;
using detail::Measurements;
using detail::Problem;

constexpr std::size_t min_fixes = 100;

std::size_t used_fixes(const std::vector<Measurements>& logs) {
  std::size_t count = 0;
  for (const Measurements& log : logs) {
    count += static_cast<std::size_t>(
        std::count_if(log.fixes.begin(), log.fixes.end(), [](const detail::Fix& fix) { return fix.used; }));
  }
  return count;
}

void check_fixes(const std::vector<Measurements>& logs) {
  const std::size_t count = used_fixes(logs);
  if (count >= min_fixes) return;
  throw CalibrationError(std::to_string(count) + " usable fixes; " + std::to_string(min_fixes) +
                         " are needed: record for a minute or two");
}

std::vector<Measurements> read(std::span<const std::vector<Event>> recordings,
                               const settings::Settings& settings) {
  constexpr std::size_t min_samples = 500;
  std::vector<Measurements> logs;
  for (const std::vector<Event>& events : recordings) {
    logs.push_back(detail::measurements_of(events, settings));
    if (logs.back().imu.size() < min_samples) {
      throw CalibrationError(std::to_string(logs.back().imu.size()) + " IMU samples; " +
                             std::to_string(min_samples) + " are needed: record for a minute or two");
    }
  }
  check_fixes(logs);
  return logs;
}

/// Yaws at the starts of logs without headings.
std::vector<double> start_yaws_of(const Problem& problem, const Fit& fit) {
  std::vector<double> yaws;
  for (std::size_t log = 0; log < problem.logs().size(); ++log) {
    yaws.push_back(problem.parameters_of(fit.unknowns, log).start_yaw_rad);
  }
  return yaws;
}

std::vector<bool> have_headings(const std::vector<Measurements>& logs) {
  std::vector<bool> have;
  for (const Measurements& log : logs) have.push_back(log.has_heading());
  return have;
}

/// Searches a start yaw for each log that had headings and has lost all of them.
void find_lost_yaws(const std::vector<Measurements>& logs, const std::vector<bool>& had_headings,
                    double delay_s, std::vector<double>& start_yaw_rad) {
  for (std::size_t log = 0; log < logs.size(); ++log) {
    if (!had_headings[log] || logs[log].has_heading()) continue;
    start_yaw_rad[log] = detail::best_start_yaw(logs[log], delay_s).yaw_rad;
  }
}

bool is_delay_known(const Fit& fit) {
  constexpr double well_known_s = 0.02;
  return fit.covariance(detail::at_delay, detail::at_delay) < well_known_s * well_known_s;
}

/// Maximises from the grid, twice: first without outliers of the grid's best point, then with the
/// measurements that the engine uses once it knows mount and delay.
Fit fit_logs(std::span<const std::vector<Event>> recordings, const settings::Settings& settings,
             const DriveOptions& options, std::vector<Measurements>& logs) {
  const auto observer_of = [&options](std::string_view stage) {
    return [&options, stage](int step) {
      if (options.on_progress) options.on_progress(stage, step);
    };
  };
  observer_of("search")(0);
  const std::vector<bool> had_headings = have_headings(logs);
  detail::Start start = detail::grid_search(logs);
  detail::reject_outliers(logs, start);
  check_fixes(logs);
  find_lost_yaws(logs, had_headings, start.parameters.delay_s, start.start_yaw_rad);
  Problem rough_problem(logs);
  const Fit rough =
      detail::maximise(rough_problem, rough_problem.vector_of(start.parameters, start.start_yaw_rad),
                       observer_of("first fit"));
  detail::Parameters found = rough_problem.parameters_of(rough.unknowns, 0);
  if (!is_delay_known(rough)) found.delay_s = 0.0;  // otherwise the engine would refuse fixes for their age
  std::vector<double> start_yaws = start_yaws_of(rough_problem, rough);
  const std::vector<bool> had_rough_headings = have_headings(logs);
  observer_of("judgement")(0);
  for (std::size_t log = 0; log < logs.size(); ++log) {
    detail::judge_by_engine(recordings[log], settings, found, logs[log]);
  }
  check_fixes(logs);
  find_lost_yaws(logs, had_rough_headings, found.delay_s, start_yaws);
  Problem problem(logs);
  return detail::maximise(problem, problem.vector_of(found, start_yaws), observer_of("fit"));
}

void count(std::span<const std::vector<Event>> recordings, const std::vector<Measurements>& logs,
           DriveFit& result) {
  double sum_s = 0;
  double squares_s2 = 0;
  for (const std::vector<Event>& events : recordings) {
    for (const Event& event : events) {
      if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
        const double delay_s = seconds_between(fix->emission_time_ns, fix->received_time_ns);
        ++result.fixes;
        sum_s += delay_s;
        squares_s2 += delay_s * delay_s;
      } else if (std::holds_alternative<PairHeading>(event)) {
        ++result.headings;
      }
    }
  }
  const auto fixes = static_cast<double>(result.fixes);
  result.stamped_delay_s = sum_s / fixes;
  result.stamped_delay_spread_s =
      std::sqrt(std::max(0.0, squares_s2 / fixes - result.stamped_delay_s * result.stamped_delay_s));
  result.fixes_used = used_fixes(logs);
  for (const Measurements& log : logs) {
    result.headings_used +=
        static_cast<std::size_t>(std::count_if(log.headings.begin(), log.headings.end(),
                                               [](const detail::Heading& heading) { return heading.used; }));
  }
}

}  // namespace

DriveFit calibrate_drive(std::span<const std::vector<Event>> recordings, const settings::Settings& settings,
                         const DriveOptions& options) {
  std::vector<Measurements> logs = read(recordings, settings);
  const Fit fit = fit_logs(recordings, settings, options, logs);
  Problem problem(logs);
  problem.start_lever_arms_at(fit.lever_arms);
  DriveFit result;
  count(recordings, logs, result);
  result.converged = fit.converged;
  detail::set_values(problem, fit, result);
  detail::check_imu(problem, fit, result);
  if (options.curves) {
    if (options.on_progress) options.on_progress("curves", 0);
    detail::add_curves(problem, fit, result);
  }
  return result;
}

}  // namespace sonopose::calibration::drive
