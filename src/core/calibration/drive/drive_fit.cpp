#include "calibration/drive/drive_fit.hpp"

#include "calibration/drive/measurements.hpp"
#include "calibration/drive/pieces.hpp"
#include "calibration/drive/scoring.hpp"
#include "calibration/drive/start.hpp"
#include "calibration/drive/values.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonopose::calibration::drive {
namespace {

using detail::Fit;
using detail::Measurements;
using detail::Problem;

constexpr std::size_t min_fixes = 100;

struct Input {
  std::span<const std::vector<Event>> recordings;
  std::vector<Measurements> logs;  ///< whole
  const settings::Settings& settings;
  const DriveOptions& options;

  [[nodiscard]] auto observer_of(std::string_view stage) const {
    return [this, stage](int step) {
      if (options.on_progress) options.on_progress(stage, step);
    };
  }
};

/// Fit of the pieces of all recordings.
struct Attempt {
  double set_back_s = 0;  ///< delay by which the stamps of fixes and headings were set back
  std::vector<Measurements> pieces;
  std::string lacking;       ///< need of a fit; empty if there is one
  std::size_t accepted = 0;  ///< number of fixes and headings that the engine uses
  Fit fit;
  DriveFit result;
};

std::size_t used_fixes(const std::vector<Measurements>& logs) {
  std::size_t count = 0;
  for (const Measurements& log : logs) {
    count += static_cast<std::size_t>(
        std::count_if(log.fixes.begin(), log.fixes.end(), [](const detail::Fix& fix) { return fix.used; }));
  }
  return count;
}

/// Reason why the fixes do not suffice; empty if they do.
std::string lack_of_fixes(std::size_t count, const std::string& cause) {
  if (count >= min_fixes) return {};
  return std::to_string(count) + " usable fixes; " + std::to_string(min_fixes) + " are needed: " + cause;
}

std::vector<Measurements> read(std::span<const std::vector<Event>> recordings,
                               const settings::Settings& settings) {
  constexpr std::size_t min_samples = 500;
  const char* const remedy = "record for a minute or two";
  std::vector<Measurements> logs;
  for (const std::vector<Event>& events : recordings) {
    logs.push_back(detail::measurements_of(events, settings));
    logs.back().recording = logs.size() - 1;
    if (logs.back().imu.size() < min_samples) {
      throw CalibrationError(std::to_string(logs.back().imu.size()) + " IMU samples; " +
                             std::to_string(min_samples) + " are needed: " + remedy);
    }
  }
  const std::string lacking = lack_of_fixes(used_fixes(logs), remedy);
  if (!lacking.empty()) throw CalibrationError(lacking);
  return logs;
}

/// Notes in the attempt if too few of the fixes are left, and why. Returns true if there are enough.
bool has_enough_fixes(const Input& input, Attempt& attempt, const std::string& cause_of_others) {
  const std::size_t count = used_fixes(attempt.pieces);
  attempt.lacking =
      lack_of_fixes(count, "the other " + std::to_string(used_fixes(input.logs) - count) + cause_of_others);
  return attempt.lacking.empty();
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
    start_yaw_rad[log] = detail::best_start_yaw_rad(logs[log], delay_s);
  }
}

bool is_delay_known(const Fit& fit) {
  constexpr double well_known_s = 0.02;
  return fit.covariance(detail::at_delay, detail::at_delay) < well_known_s * well_known_s;
}

/// Restricts fixes and headings to those that the engine uses once it knows mount and delay.
void judge_by_engine(const Input& input, double mount_rad, double delay_s, Attempt& attempt) {
  for (std::size_t at = 0; at < input.recordings.size(); ++at) {
    const std::vector<Event>& events = input.recordings[at];
    const auto used = attempt.set_back_s == 0.0
                          ? detail::used_by_engine(events, input.settings, mount_rad, delay_s)
                          : detail::used_by_engine(detail::set_back(events, attempt.set_back_s),
                                                   input.settings, mount_rad, delay_s);
    attempt.accepted += used.size();
    for (Measurements& piece : attempt.pieces) {
      if (piece.recording != at) continue;
      for (detail::Fix& fix : piece.fixes) fix.used = used.contains(fix.sequence);
      for (detail::Heading& heading : piece.headings) heading.used = used.contains(heading.sequence);
    }
  }
}

/// Maximises from the grid, twice: first without outliers of the grid's best point, then with the
/// measurements that the engine uses once it knows mount and delay.
void fit_pieces(const Input& input, Attempt& attempt) {
  constexpr int max_rounds = 4;
  std::vector<Measurements>& pieces = attempt.pieces;
  for (const Measurements& log : input.logs) {
    detail::append_pieces(detail::set_back(log, attempt.set_back_s), pieces);
  }
  if (!has_enough_fixes(input, attempt,
                        " have no IMU samples around them, at least for six seconds without a silence")) {
    return;
  }
  input.observer_of("search")(0);
  const std::vector<bool> had_headings = have_headings(pieces);
  detail::Start start = detail::grid_search(pieces);
  detail::reject_outliers(pieces, start);
  if (!has_enough_fixes(input, attempt, " contradict them or the IMU" + detail::or_clocks())) return;
  find_lost_yaws(pieces, had_headings, start.parameters.delay_s, start.start_yaw_rad);
  Problem rough_problem(pieces);
  const Fit rough =
      detail::maximise(rough_problem, rough_problem.vector_of(start.parameters, start.start_yaw_rad),
                       input.observer_of("first fit"));
  detail::Parameters found = rough_problem.parameters_of(rough.unknowns, 0);
  if (!is_delay_known(rough)) found.delay_s = 0.0;  // otherwise the engine would refuse fixes for their age
  std::vector<double> start_yaws = start_yaws_of(rough_problem, rough);
  const std::vector<bool> had_rough_headings = have_headings(pieces);
  input.observer_of("judgement")(0);
  judge_by_engine(input, found.mount_rad, found.delay_s, attempt);
  if (!has_enough_fixes(input, attempt, " are refused by the fusion, and sonopose-replay says why")) return;
  find_lost_yaws(pieces, had_rough_headings, found.delay_s, start_yaws);
  Problem problem(pieces);
  attempt.fit = detail::maximise(problem, problem.vector_of(found, start_yaws), input.observer_of("fit"));
  // The engine also uses measurements that are somewhat wrong for some seconds.
  for (int round = 0; round < max_rounds && detail::reject_tail(pieces, attempt.fit.passes); ++round) {
    if (!has_enough_fixes(input, attempt, " are far from the motion")) return;
    attempt.fit = detail::maximise(problem, attempt.fit.unknowns, input.observer_of("fit"));
  }
  attempt.result.converged = attempt.fit.converged;
  problem.start_lever_arms_at(attempt.fit.lever_arms);
  detail::set_values(problem, attempt.fit, attempt.result);
  detail::check_imu(problem, attempt.fit, attempt.result);
}

/// True if the attempt knows the delay, and the margins of the pieces are wide enough for it.
bool has_delay(const Attempt& attempt) {
  constexpr double max_delay_s = 0.3;
  static_assert(max_delay_s < detail::margin_s);
  const Value& delay = attempt.result[Quantity::delay];
  return attempt.lacking.empty() && delay.is_known() && std::abs(delay.value) <= max_delay_s;
}

/// True if the fit needs an accelerometer much noisier than its samples.
bool contradicts_imu(const Attempt& attempt) {
  constexpr double max_noise_ratio = 20.0;  // vibration and slip cause up to some times the scatter
  const double scatter = detail::scatter_rthz(attempt.pieces, &detail::ImuMeasurement::force_body_mps2);
  return std::exp(attempt.fit.unknowns(detail::at_accel)) >= max_noise_ratio * scatter;
}

double max_correction_s() {
  return std::get<double>(settings::setting_info("delay.correction_s").maximum);
}

/// True if the attempt shows an offset of the clocks that the one without it cannot explain. It is beyond any
/// setting, so that it need not be as exact as one.
bool has_clock_offset(const Attempt& attempt, const Attempt& without) {
  constexpr double max_half_width_s = 0.05;
  const bool is_explained = without.lacking.empty() && !contradicts_imu(without) &&
                            std::isfinite(without.result[Quantity::delay].low);
  if (!attempt.lacking.empty() || is_explained || contradicts_imu(attempt)) return false;
  const Value& delay = attempt.result[Quantity::delay];
  return delay.high - delay.value <= max_half_width_s &&
         std::abs(attempt.set_back_s + delay.value) > max_correction_s();
}

/// Names the clocks if the fit contradicts the accelerometer: then it is no lack of motion that hides the
/// delay.
void name_clocks(Attempt& attempt) {
  Value& delay = attempt.result[Quantity::delay];
  if (!attempt.lacking.empty() || delay.is_known() || !contradicts_imu(attempt)) return;
  delay.missing =
      "set the clock of the IMU, or correct its stamps, or calibrate it: its accelerations contradict the "
      "fixes" +
      detail::or_clocks();
}

/// Fits with the stamps as they are. If that shows no delay, the clocks of fixes and IMU may differ by more
/// than the search covers.
Attempt best_attempt(const Input& input) {
  Attempt attempt;
  fit_pieces(input, attempt);
  if (has_delay(attempt)) return attempt;
  Attempt other;
  other.set_back_s = detail::coarse_delay_s(input.logs, input.observer_of("search of the clocks"));
  if (other.set_back_s != 0.0) {
    fit_pieces(input, other);
    if (has_delay(other)) return other;
    if (has_clock_offset(other, attempt)) {
      other.result[Quantity::delay].missing.clear();
      return other;
    }
  }
  name_clocks(attempt);
  return attempt;
}

/// Returns why the fusion cannot correct this delay; empty if it can.
std::string clock_fault(const Input& input, const Attempt& attempt, double delay_s) {
  constexpr double min_share = 0.9;
  bool is_correctable = std::abs(delay_s) <= max_correction_s();
  if (is_correctable && attempt.set_back_s != 0.0) {
    const double mount_rad = attempt.fit.unknowns(detail::at_mount);
    std::size_t accepted = 0;
    for (const std::vector<Event>& events : input.recordings) {
      accepted += detail::used_by_engine(events, input.settings, mount_rad, delay_s).size();
    }
    is_correctable = static_cast<double>(accepted) >= min_share * static_cast<double>(attempt.accepted);
  }
  if (is_correctable) return {};
  return "the stamps of the IMU are " + std::to_string(std::lround(1e3 * std::abs(delay_s))) + " ms " +
         (delay_s < 0.0 ? "ahead of" : "behind") +
         " those of the fixes, more than delay.correction_s can correct: set the clock that stamps them, or "
         "correct the stamps in the driver";
}

/// Adds the delay by which the stamps were set back.
void add_to_delay(double delay_s, DriveFit& result) {
  Value& delay = result[Quantity::delay];
  delay.value += delay_s;
  delay.low += delay_s;
  delay.high += delay_s;
  for (CurvePoint& point : result.curves[static_cast<std::size_t>(Quantity::delay)]) point.value += delay_s;
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
  const Input input{recordings, read(recordings, settings), settings, options};
  Attempt attempt = best_attempt(input);
  if (!attempt.lacking.empty()) throw CalibrationError(attempt.lacking);
  DriveFit& result = attempt.result;
  count(recordings, attempt.pieces, result);
  for (const Measurements& log : input.logs) result.imu_silences += detail::silences_in(log);
  result.used_s = detail::duration_s(attempt.pieces);
  if (options.curves) {
    if (options.on_progress) options.on_progress("curves", 0);
    Problem problem(attempt.pieces);
    problem.start_lever_arms_at(attempt.fit.lever_arms);
    detail::add_curves(problem, attempt.fit, result);
  }
  add_to_delay(attempt.set_back_s, result);
  if (result[Quantity::delay].is_known()) {
    result.clock_fault = clock_fault(input, attempt, result[Quantity::delay].value);
  }
  return std::move(attempt.result);
}

}  // namespace sonopose::calibration::drive
