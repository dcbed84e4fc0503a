#pragma once
/// \file
/// Simulated drives with a random installation, and the errors of their calibration.

#include "calibration/drive/drive_fit.hpp"
#include "sim/simulator.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

namespace sonopose::test {

/// A recording and the true result of its calibration.
struct SimulatedDrive {
  std::vector<std::vector<Event>> recordings;
  std::array<double, calibration::drive::quantity_count> truth{};  ///< in the order of Quantity

  [[nodiscard]] double true_value(calibration::drive::Quantity quantity) const {
    return truth[static_cast<std::size_t>(quantity)];
  }
};

inline SimulatedDrive drive_with(std::string_view scenario, const sim::SensorSettings& sensors,
                                 std::uint64_t seed, double duration_s = 120.0) {
  sim::Scenario installed = sim::find_scenario(scenario);
  installed.sensors = sensors;
  const Vector3d& arm_m = sensors.imu_from_tracked_point_body_m;
  const double root_of_period = std::sqrt(1.0 / sensors.imu_rate_hz);
  return {{sim::record(installed, {.seed = seed, .duration_s = duration_s}).events},
          {sensors.pair_mount_offset_rad, -sensors.reported_delay_error_s, arm_m.x(), arm_m.y(), arm_m.z(),
           sensors.fix_noise_m.max, sensors.fix_noise_m.max, sensors.heading_noise_rad,
           sensors.accel_noise_mps2 * root_of_period, sensors.gyro_noise_radps * root_of_period}};
}

/// A drive with mount, delay, lever arm and noise drawn from the seed.
inline SimulatedDrive random_drive(std::string_view scenario, std::uint64_t seed, double duration_s = 120.0) {
  constexpr std::uint64_t stream = 99;
  sim::Random random(seed, stream);
  sim::SensorSettings sensors = sim::find_scenario(scenario).sensors;
  sensors.pair_mount_offset_rad = random.uniform_in({-std::numbers::pi, std::numbers::pi});
  sensors.reported_delay_error_s = random.uniform_in({-0.15, 0.15});
  for (double& component : sensors.imu_from_tracked_point_body_m) component = random.uniform_in({-0.1, 0.1});
  sensors.fix_noise_m = random.uniform_in({0.015, 0.025});
  sensors.heading_noise_rad = random.uniform_in({0.5, 1.5}) * geometry::radians_per_degree;
  return drive_with(scenario, sensors, seed, duration_s);
}

/// Found minus true; angles are wrapped.
inline double error_of(const SimulatedDrive& drive, const calibration::drive::DriveFit& fit,
                       calibration::drive::Quantity quantity) {
  const double error = fit[quantity].value - drive.true_value(quantity);
  return quantity == calibration::drive::Quantity::mount ? geometry::wrap_angle(error) : error;
}

/// Returns true if the interval contains the truth.
inline bool is_covered(const SimulatedDrive& drive, const calibration::drive::DriveFit& fit,
                       calibration::drive::Quantity quantity) {
  const auto& value = fit[quantity];
  const double error = error_of(drive, fit, quantity);
  return value.low <= value.value - error && value.value - error <= value.high;
}

}  // namespace sonopose::test
