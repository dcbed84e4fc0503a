#include "calibration/drive/values.hpp"

#include "calibration/drive/course.hpp"
#include "calibration/drive/measurements.hpp"
#include "calibration/drive/start.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::calibration::drive::detail {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Row {
  Quantity quantity;
  Unknown unknown;
  bool is_logarithm;
  double max_half_width;  ///< largest half of the interval, or of its logarithm; that of a delay depends on
                          ///< the drive
  const char* missing;
};

constexpr double radians_per_degree = geometry::radians_per_degree;

const std::array<Row, common_unknowns> rows{{
    {Quantity::mount, at_mount, false, 1.5 * radians_per_degree,
     "accelerate and brake on straight legs, or drive curves of changing radius: at rest and at constant "
     "velocity the accelerations that show the yaw of the IMU are missing, and on one circle another mount "
     "looks like another lever arm"},
    {Quantity::delay, at_delay, false, 0.0,
     "change speed and direction: at constant velocity a delay looks like a displacement, on one circle "
     "like another mount"},
    {Quantity::fix_horizontal, at_fix_horizontal, true, 0.25, "record for longer: there are too few fixes"},
    {Quantity::fix_vertical, at_fix_vertical, true, 0.25, "record for longer: there are too few fixes"},
    {Quantity::heading, at_heading, true, 0.25, "record for longer: there are too few headings of a pair"},
    {Quantity::accel, at_accel, true, 1.5, "record for longer: the noise of the fixes hides that of the IMU"},
    {Quantity::gyro, at_gyro, true, 1.5,
     "record for longer: the noise of fixes and headings hides that of the IMU"},
}};

constexpr std::array<Quantity, 3> lever_arm{Quantity::lever_arm_x, Quantity::lever_arm_y,
                                            Quantity::lever_arm_z};
constexpr double max_lever_arm_half_width_m = 0.005;

bool has_heading(const Problem& problem) {
  return std::any_of(problem.logs().begin(), problem.logs().end(),
                     [](const Measurements& log) { return log.has_heading(); });
}

/// Information about the mount that the IMU's noise alone seems to give. The likelihood takes each sample for
/// a motion, also at rest. The filter's expectation of such errors is its variance of position, as a share of
/// the innovation's.
double information_of_noise(const Problem& problem, const Fit& fit) {
  constexpr double noise_information_factor = 3.0;
  double sum = 0;
  for (std::size_t log = 0; log < fit.passes.size(); ++log) {
    const double noise_m = problem.parameters_of(fit.unknowns, log).fix_horizontal_m;
    for (const Residual& residual : fit.passes[log].residuals) {
      if (residual.is_heading) continue;
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        sum += 1.0 - noise_m * noise_m / residual.covariance(axis, axis);
      }
    }
  }
  return noise_information_factor * sum;
}

double std_of(const Problem& problem, const Fit& fit, Unknown unknown) {
  const double variance = fit.covariance(unknown, unknown);
  if (unknown != at_mount) return std::sqrt(variance);
  const double information = 1.0 / variance - information_of_noise(problem, fit);
  return information > 0.0 ? 1.0 / std::sqrt(information) : infinite;
}

/// Value for which an unknown stands.
double value_of(const Row& row, double unknown) {
  if (row.unknown == at_fix_horizontal || row.unknown == at_fix_vertical) return fix_noise_m(unknown);
  return row.is_logarithm ? std::exp(unknown) : unknown;
}

/// Uncertainty of a delay that displaces a fix by no more than its noise, at the speed of the drive.
double max_delay_half_width_s(const Problem& problem) {
  constexpr double displacement_m = 0.015;
  constexpr double min_half_width_s = 0.0025;
  constexpr double max_half_width_s = 0.008;
  return std::clamp(displacement_m / rms_speed_mps(problem.logs()), min_half_width_s, max_half_width_s);
}

Value interval_of(const Row& row, double unknown, double std, double max_half_width) {
  const double half = interval_stds * std;
  Value value;
  if (row.quantity == Quantity::mount) {
    const double mount_rad = geometry::wrap_angle(unknown);
    value = {mount_rad, mount_rad - half, mount_rad + half, {}};
  } else {
    value = {value_of(row, unknown), value_of(row, unknown - half), value_of(row, unknown + half), {}};
  }
  if (!(half <= max_half_width)) value.missing = row.missing;
  return value;
}

/// Combines the lever arms of all logs by their weights.
void set_lever_arm(const Fit& fit, DriveFit& result) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double weights = 0;
    double sum = 0;
    for (const LeverArm& arm : fit.lever_arms) {
      const double weight = 1.0 / arm.covariance_m2(axis, axis);
      weights += weight;
      sum += weight * arm.value_m(axis);
    }
    const double half_m = interval_stds / std::sqrt(weights);
    const double value_m = sum / weights;
    Value value{value_m, value_m - half_m, value_m + half_m, {}};
    if (!(half_m <= max_lever_arm_half_width_m)) {
      value.missing = axis == 2
                          ? "tilt the vehicle: pitch or roll by more than some degrees, again and again"
                          : "turn about the vertical, at changing rates, left and right, and for longer";
    }
    result[lever_arm.at(static_cast<std::size_t>(axis))] = value;
  }
}

void set_innovations(const Fit& fit, DriveFit& result) {
  std::size_t fixes = 0;
  std::size_t headings = 0;
  for (const Pass& pass : fit.passes) {
    for (const Residual& residual : pass.residuals) {
      (residual.is_heading ? result.squared_heading_innovation : result.squared_fix_innovation) +=
          residual.squared_norm;
      ++(residual.is_heading ? headings : fixes);
    }
  }
  result.squared_fix_innovation /= std::max(1.0, 3.0 * static_cast<double>(fixes));
  result.squared_heading_innovation /= std::max(1.0, static_cast<double>(headings));
}

void mark_unknown(Value& value, const std::string& missing) {
  value = {value.value, -infinite, infinite, missing};
}

void set_mount_from_course(const Problem& problem, DriveFit& result) {
  constexpr double max_half_width_rad = 10.0 * radians_per_degree;
  result.mount_method = MountMethod::course;
  result.why_course = "the likelihood needs a gyroscope much noisier than its samples are";
  Value& mount = result[Quantity::mount];
  const auto course = mount_from_course(problem.logs());
  if (!course) {
    mount.missing = "drive faster than 0.5 m/s for some ten seconds, along the X axis";
    return;
  }
  // Slip outlasts a window, so more windows do not improve the mean.
  const double half_rad = interval_stds * course->spread_rad;
  mount = {course->mount_rad, course->mount_rad - half_rad, course->mount_rad + half_rad, {}};
  if (half_rad > max_half_width_rad)
    mount.missing = "drive along the X axis: the heading does not follow the course";
}

}  // namespace

void set_values(const Problem& problem, const Fit& fit, DriveFit& result) {
  for (const Row& row : rows) {
    const double max_half_width =
        row.quantity == Quantity::delay ? max_delay_half_width_s(problem) : row.max_half_width;
    result[row.quantity] =
        interval_of(row, fit.unknowns(row.unknown), std_of(problem, fit, row.unknown), max_half_width);
  }
  set_lever_arm(fit, result);
  set_innovations(fit, result);
  if (!has_heading(problem)) {
    const bool is_pair = std::any_of(problem.logs().begin(), problem.logs().end(),
                                     [](const Measurements& log) { return !log.headings.empty(); });
    const char* const missing =
        is_pair ? "record headings that agree with the IMU and arrive in time: none of them could be used"
                : "record the headings of paired beacons: there are none";
    mark_unknown(result[Quantity::mount], missing);
    mark_unknown(result[Quantity::heading], missing);
  }
}

std::string or_clocks() {
  return ", or the clocks differ by more than the " + std::to_string(std::lround(max_clock_offset_s)) +
         " s that were searched";
}

void check_imu(const Problem& problem, const Fit& fit, DriveFit& result) {
  constexpr double max_gyro_noise_ratio = 5.0;  // times the noise that consecutive samples show
  const double scatter = scatter_rthz(problem.logs(), &ImuMeasurement::rate_body_radps);
  if (!result[Quantity::gyro].is_known() ||
      std::exp(fit.unknowns(at_gyro)) <= max_gyro_noise_ratio * scatter) {
    if (fit.converged) return;
    for (Value& value : result.values) {
      if (value.is_known()) mark_unknown(value, "record again: the search found no maximum");
    }
    return;
  }
  for (Value& value : result.values) {
    mark_unknown(
        value,
        "calibrate or replace the IMU, set its clock, or record without slip: its rates and accelerations "
        "contradict the fixes" +
            or_clocks());
  }
  if (has_heading(problem)) set_mount_from_course(problem, result);
}

void add_curves(const Problem& problem, const Fit& fit, DriveFit& result) {
  constexpr int points_per_side = 6;  // on each side
  constexpr double max_stds = 3.0;
  for (const Row& row : rows) {
    if (!result[row.quantity].is_known()) continue;
    if (row.quantity == Quantity::mount && result.mount_method == MountMethod::course) continue;
    // The others take their most probable values.
    const Eigen::VectorXd along =
        fit.covariance.col(row.unknown) / std::sqrt(fit.covariance(row.unknown, row.unknown));
    auto& curve = result.curves[static_cast<std::size_t>(row.quantity)];
    for (int point = -points_per_side; point <= points_per_side; ++point) {
      const Eigen::VectorXd unknowns = fit.unknowns + max_stds * point / points_per_side * along;
      const double minus_2_log_l = problem.minus_2_log_l(unknowns, problem.passes(unknowns));
      curve.push_back({value_of(row, unknowns(row.unknown)), 0.5 * (fit.minus_2_log_l - minus_2_log_l)});
    }
  }
}

}  // namespace sonopose::calibration::drive::detail
