#include "fit_support.hpp"
#include "least_squares.hpp"
#include <sonopose/calibration/inertial_fit.hpp>
#include <sonopose/math/rotation.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace sonopose::calibration {
namespace {

using detail::Solution;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double largest_condition = 100.0;

// The parameters in the fit's order.
constexpr std::array<std::string_view, 9> names{
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

/// The samples between two periods, and where gravity stood before and after (unit vectors, body).
struct Turn {
  std::span<const ImuSample> imu;
  Vector3d up_before;
  Vector3d up_after;
};

std::vector<Turn> turns_between(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                                const AccelerometerSettings& accelerometer) {
  constexpr double longest_s = 30.0;  // beyond, the offset's error counts
  constexpr double least_angle_rad = 0.3;
  const Affine model = model_of(accelerometer);
  const double widest_gap_s = 5.0 * usual_period_s(imu);
  std::vector<Turn> turns;
  for (std::size_t i = 1; i < intervals.size(); ++i) {
    const std::size_t begin = intervals[i - 1].end - 1;
    const Turn turn{imu.subspan(begin, intervals[i].begin + 1 - begin),
                    model(intervals[i - 1].mean_force_mps2).normalized(),
                    model(intervals[i].mean_force_mps2).normalized()};
    const double took_s = seconds_between(turn.imu.front().sensor_time_ns, turn.imu.back().sensor_time_ns);
    bool usable = took_s <= longest_s && turn.up_before.dot(turn.up_after) < std::cos(least_angle_rad);
    for (std::size_t k = 1; k < turn.imu.size() && usable; ++k) {
      const double dt_s = seconds_between(turn.imu[k - 1].sensor_time_ns, turn.imu[k].sensor_time_ns);
      usable = dt_s > 0.0 && dt_s <= widest_gap_s;
    }
    if (usable) turns.push_back(turn);
  }
  return turns;
}

/// Gravity's direction after the turn as the rates tell it, minus as it was measured: three per turn.
VectorXd residuals_of(const std::vector<Turn>& turns, const GyroscopeSettings& settings) {
  const Affine model = model_of(settings);
  VectorXd residuals(3 * static_cast<Index>(turns.size()));
  for (std::size_t i = 0; i < turns.size(); ++i) {
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
    const auto& imu = turns[i].imu;
    Vector3d before_radps = model(imu.front().angular_velocity_body_radps);
    for (std::size_t k = 1; k < imu.size(); ++k) {
      const double dt_s = seconds_between(imu[k - 1].sensor_time_ns, imu[k].sensor_time_ns);
      const Vector3d rate_radps = model(imu[k].angular_velocity_body_radps);
      turned = turned * math::rotation_by(0.5 * dt_s * (before_radps + rate_radps));
      before_radps = rate_radps;
    }
    residuals.segment<3>(3 * static_cast<Index>(i)) =
        turned.normalized().conjugate() * turns[i].up_before - turns[i].up_after;
  }
  return residuals;
}

double rms_of(const VectorXd& residuals) {
  return std::sqrt(3.0 * residuals.squaredNorm() / static_cast<double>(residuals.size()));
}

void refine_by_turns(const std::vector<Turn>& turns, GyroscopeFit& fit) {
  constexpr std::size_t least_turns = 9;
  fit.turns = turns.size();
  if (turns.size() < least_turns) {
    fit.why_without = std::to_string(turns.size()) + " turns from one still period to the next were found, " +
                      std::to_string(least_turns) + " are needed";
    return;
  }
  VectorXd start = VectorXd::Zero(static_cast<Index>(names.size()));
  start.head<3>().setOnes();
  const auto residuals = [&](const VectorXd& at) {
    return residuals_of(turns, settings_of(at, fit.settings));
  };
  fit.rms_before_rad = rms_of(residuals(start));
  constexpr double step = 1e-5;
  const Solution solution = detail::minimise(detail::differentiated(residuals, step), start);
  if (!(solution.condition <= largest_condition)) {
    fit.why_without = "the turns do not determine it, least of all " +
                      std::string(detail::weakest_of(solution, names)) + ": turn about each of the axes";
    return;
  }
  fit.settings = settings_of(solution.parameters, fit.settings);
  fit.standard_errors = settings_of(solution.standard_errors(), fit.standard_errors);
  fit.rms_after_rad = rms_of(solution.residuals);
  fit.with_sensitivity = true;
  detail::check_ranges(fit.settings);
}

}  // namespace

GyroscopeFit fit_gyroscope(std::span<const StillInterval> intervals) {
  if (intervals.empty()) {
    throw CalibrationError(
        "the sensor was never still for a second: lay it down for 2 s at least once, better several times");
  }
  Vector3d offset_radps = Vector3d::Zero();
  double samples = 0.0;
  for (const StillInterval& interval : intervals) {
    offset_radps += static_cast<double>(interval.count()) * interval.mean_rate_radps;
    samples += static_cast<double>(interval.count());
  }
  offset_radps /= samples;
  // What the periods' scatter tells of the error, but never less than what the noise does.
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
  fit.standard_errors = settings_of(VectorXd::Zero(static_cast<Index>(names.size())), fit.settings);
  fit.standard_errors.offset_x_radps = std::sqrt(variance.x());
  fit.standard_errors.offset_y_radps = std::sqrt(variance.y());
  fit.standard_errors.offset_z_radps = std::sqrt(variance.z());
  detail::check_ranges(fit.settings);
  return fit;
}

GyroscopeFit fit_gyroscope(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                           const AccelerometerSettings& accelerometer) {
  GyroscopeFit fit = fit_gyroscope(intervals);
  refine_by_turns(turns_between(imu, intervals, accelerometer), fit);
  return fit;
}

}  // namespace sonopose::calibration
