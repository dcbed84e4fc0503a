#include "calibration/fit/fit_support.hpp"
#include "calibration/fit/inertial_fit.hpp"
#include "calibration/fit/least_squares.hpp"
#include "calibration/fit/turns.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/statistics/quantile.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::calibration::fit {
namespace {

using detail::residuals_of;
using detail::Solution;
using detail::Turn;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double max_gyroscope_condition = 100.0;
constexpr double differences_step = 1e-5;

// Parameters in the fit's order.
constexpr std::array<std::string_view, 9> gyroscope_names{
    "the sensitivity of X", "the sensitivity of Y", "the sensitivity of Z",
    "the misalignment xy",  "the misalignment xz",  "the misalignment yx",
    "the misalignment yz",  "the misalignment zx",  "the misalignment zy"};

GyroscopeSettings settings_of(const VectorXd& parameters, GyroscopeSettings settings) {
  settings.sensitivity_x = parameters[0];
  settings.sensitivity_y = parameters[1];
  settings.sensitivity_z = parameters[2];
  settings.misalignment_xy = parameters[3];
  settings.misalignment_xz = parameters[4];
  settings.misalignment_yx = parameters[5];
  settings.misalignment_yz = parameters[6];
  settings.misalignment_zx = parameters[7];
  settings.misalignment_zy = parameters[8];
  return settings;
}

/// Parameters of a sensor without errors.
VectorXd no_errors() {
  VectorXd parameters = VectorXd::Zero(static_cast<Index>(gyroscope_names.size()));
  parameters.head<3>().setOnes();
  return parameters;
}

double rms_of(const VectorXd& residuals) {
  return std::sqrt(3.0 * residuals.squaredNorm() / static_cast<double>(residuals.size()));
}

/// Solves for sensitivity and misalignment from the turns, with the offset of `settings`.
Solution solve(const std::vector<Turn>& turns, const GyroscopeSettings& settings) {
  const auto residuals = [&](const VectorXd& at) { return residuals_of(turns, settings_of(at, settings)); };
  return detail::minimise(detail::differentiated(residuals, differences_step), no_errors());
}

/// Error of each turn (rad).
Eigen::ArrayXd misses_of(const VectorXd& residuals) {
  return residuals.reshaped(3, residuals.size() / 3).colwise().norm().transpose();
}

/// Deviation of each turn from the majority (rad). Least squares would spread the error of one bad turn over
/// all turns; the least sum of absolute errors does not. It is computed by iteratively reweighted least
/// squares.
Eigen::ArrayXd robust_misses(const std::vector<Turn>& turns, const GyroscopeSettings& settings) {
  constexpr int rounds = 10;
  constexpr double min_miss_rad = 0.05 * geometry::radians_per_degree;
  VectorXd parameters = no_errors();
  Eigen::ArrayXd weights = Eigen::ArrayXd::Ones(static_cast<Index>(turns.size()));
  Eigen::ArrayXd misses_rad;
  for (int round = 0; round < rounds; ++round) {
    const auto weighted = [&](const VectorXd& at) {
      VectorXd residuals = residuals_of(turns, settings_of(at, settings));
      for (Index i = 0; i < weights.size(); ++i) residuals.segment<3>(3 * i) *= weights[i];
      return residuals;
    };
    const Solution solution =
        detail::minimise(detail::differentiated(weighted, differences_step), std::move(parameters));
    parameters = solution.parameters;
    misses_rad = misses_of(solution.residuals) / weights;
    weights = (min_miss_rad / misses_rad.max(min_miss_rad)).sqrt();
  }
  return misses_rad;
}

/// Removes turns that are off by far more than most: something disturbed them.
std::vector<Turn> without_outliers(const std::vector<Turn>& turns, const Eigen::ArrayXd& misses_rad) {
  constexpr double limit_in_medians = 4.0;
  constexpr double min_limit_rad = 0.25 * geometry::radians_per_degree;  // no turn is bad for less
  const double median_rad = statistics::quantile({misses_rad.begin(), misses_rad.end()}, 0.5);
  const double limit_rad = std::max(min_limit_rad, limit_in_medians * median_rad);
  std::vector<Turn> kept;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (misses_rad[static_cast<Index>(i)] <= limit_rad) kept.push_back(turns[i]);
  }
  return kept;
}

/// Reason not to use the solution; empty if there is none.
std::string objection_to(const Solution& solution, const GyroscopeSettings& settings) {
  constexpr double max_rms_rad = geometry::radians_per_degree;
  if (!(solution.condition <= max_gyroscope_condition)) {
    return "the turns do not determine it, least of all " +
           std::string(detail::weakest_of(solution, gyroscope_names)) + ": turn about each of the axes";
  }
  const double rms_rad = rms_of(solution.residuals);
  if (!(rms_rad <= max_rms_rad)) {
    return "the direction of gravity after a turn, integrated from the rates, is off by " +
           detail::text_of(rms_rad / geometry::radians_per_degree) + " degrees RMS, more than " +
           detail::text_of(max_rms_rad / geometry::radians_per_degree) +
           " degrees: samples are missing or wrong, or a turn exceeded the range of the sensor";
  }
  return out_of_range(terms_of(settings));
}

void refine_by_turns(std::vector<Turn> turns, GyroscopeFit& fit) {
  constexpr std::size_t min_turns = 9;
  const std::size_t found = turns.size();
  if (found >= min_turns) turns = without_outliers(turns, robust_misses(turns, fit.settings));
  fit.turns = turns.size();
  fit.turns_left_out = found - turns.size();
  if (turns.size() < min_turns) {
    fit.why_without = std::to_string(found) + " turns from one still period to the next were found, " +
                      (turns.size() < found ? std::to_string(turns.size()) + " of them agree, " : "") +
                      std::to_string(min_turns) + " are needed";
    return;
  }
  const Solution solution = solve(turns, fit.settings);
  fit.rms_before_rad = rms_of(residuals_of(turns, fit.settings));
  const GyroscopeSettings settings = settings_of(solution.parameters, fit.settings);
  fit.why_without = objection_to(solution, settings);
  if (!fit.why_without.empty()) return;
  fit.settings = settings;
  fit.standard_errors = settings_of(solution.standard_errors(), fit.standard_errors);
  fit.rms_after_rad = rms_of(solution.residuals);
  fit.with_sensitivity = true;
}

}  // namespace

GyroscopeFit fit_gyroscope(std::span<const StillInterval> intervals) {
  if (intervals.empty()) {
    throw CalibrationError(
        "the sensor was never still for a second: keep it still for 2 s, preferably several times");
  }
  Vector3d offset_radps = Vector3d::Zero();
  double samples = 0.0;
  for (const StillInterval& interval : intervals) {
    offset_radps += static_cast<double>(interval.count()) * interval.mean_rate_radps;
    samples += static_cast<double>(interval.count());
  }
  offset_radps /= samples;
  // The error follows from the scatter of the periods, but is never less than the noise implies.
  const auto periods = static_cast<double>(intervals.size());
  double noise_variance = 0.0;
  Vector3d variance = Vector3d::Zero();
  for (const StillInterval& interval : intervals) {
    noise_variance += std::pow(interval.rate_error_radps / periods, 2);
    if (intervals.size() > 1) {
      variance += (interval.mean_rate_radps - offset_radps).cwiseAbs2() / (periods * (periods - 1.0));
    }
  }
  variance = variance.cwiseMax(noise_variance);
  GyroscopeFit fit;
  fit.periods = intervals.size();
  fit.settings.offset_x_radps = offset_radps.x();
  fit.settings.offset_y_radps = offset_radps.y();
  fit.settings.offset_z_radps = offset_radps.z();
  fit.standard_errors = settings_of(VectorXd::Zero(static_cast<Index>(gyroscope_names.size())), fit.settings);
  fit.standard_errors.offset_x_radps = std::sqrt(variance.x());
  fit.standard_errors.offset_y_radps = std::sqrt(variance.y());
  fit.standard_errors.offset_z_radps = std::sqrt(variance.z());
  detail::check_ranges(fit.settings);
  return fit;
}

GyroscopeFit fit_gyroscope(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                           const AccelerometerSettings& accelerometer) {
  GyroscopeFit fit = fit_gyroscope(intervals);
  refine_by_turns(detail::turns_between(imu, intervals, accelerometer), fit);
  return fit;
}

}  // namespace sonopose::calibration::fit
