// The AHRS with all features: calibration and mounting of the sensors, gyroscope offset, rejection, internal
// states, flags, and outputs in an Earth convention. The argument is an imu.csv; without it a built-in
// movement is used. Prints once per second.

#include "movement.hpp"
#include <sonopose/attitude/ahrs.hpp>
#include <sonopose/calibration/model/calibration.hpp>

#include <cstdio>
#include <exception>

namespace {

using namespace sonopose;

constexpr auto convention = attitude::Convention::nwu;

/// Magnetic north is along world Y, so the world is east-north-up.
const Eigen::Vector2d north_world(0, 1);

attitude::Measurement<double> measurement_of(const ImuSample& imu, double dt_s) {
  attitude::Measurement<double> measurement;
  measurement.dt_s = dt_s;
  measurement.angular_velocity_body_radps = imu.angular_velocity_body_radps;
  measurement.specific_force_body_mps2 = imu.specific_force_body_mps2;
  measurement.magnetic_field_body_t = imu.magnetic_field_body_t.value_or(Vector3d::Zero());
  measurement.north_world = north_world;
  return measurement;
}

void print_outputs(double time_s, const attitude::Ahrs& ahrs, const ImuSample& imu) {
  const Quaterniond q = attitude::orientation_in(convention, north_world, ahrs.orientation());
  const auto angles = geometry::euler_angles_of(q);
  constexpr double degree = geometry::radians_per_degree;
  const Vector3d acceleration = attitude::vector_in(
      convention, north_world,
      attitude::earth_acceleration_world_mps2(ahrs.orientation(), imu.specific_force_body_mps2));
  std::printf("%6.1f s  roll %6.1f  pitch %6.1f  yaw %6.1f deg  north %5.2f  west %5.2f  up %5.2f m/s2",
              time_s, angles.roll_rad / degree, angles.pitch_rad / degree, angles.yaw_rad / degree,
              acceleration.x(), acceleration.y(), acceleration.z());
}

void print_condition(const attitude::Ahrs& ahrs, const attitude::AhrsSettings& settings) {
  const auto states = ahrs.internal_states(settings);
  const attitude::AhrsFlags flags = ahrs.flags(settings);
  if (flags.initialising) std::printf("  initialising");
  if (flags.over_range) std::printf("  over range");
  if (states.accelerometer_ignored)
    std::printf("  accelerometer ignored at %.0f deg", states.acceleration_error_deg);
  if (flags.acceleration_timeout) std::printf("  acceleration timeout");
  if (states.magnetometer_ignored)
    std::printf("  magnetometer ignored at %.0f deg", states.magnetic_error_deg);
  if (flags.magnetic_warning) std::printf("  magnetic timer %.2f", states.magnetic_timer);
  if (flags.magnetic_timeout) std::printf("  magnetic timeout");
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<ImuSample> samples = example::samples(argc, argv);

  // Calibration by sonopose-calibrate, and the mounting. The built-in sensor only has an offset, which the
  // AHRS learns.
  calibration::Settings sensor;
  sensor.accelerometer.offset_x_mps2 = 0.0;
  sensor.axes.axes = calibration::Axes::as_mounted;
  const calibration::Calibration calibration(sensor);

  attitude::AhrsSettings settings;
  settings.gain = 0.5;
  settings.acceleration_rejection_deg = 10.0;
  settings.magnetic_rejection_deg = 20.0;
  settings.rejection_timeout_s = 5.0;
  settings.rejection = attitude::RejectionForm::recovery;
  settings.gyro_range_dps = 2000.0;

  attitude::Ahrs ahrs;
  TimeNs before_ns = samples.empty() ? 0 : samples.front().sensor_time_ns;
  double since_start_s = 0.0;
  double next_print_s = 0.0;
  for (const ImuSample& raw : samples) {
    const ImuSample imu = calibration.corrected(raw);
    const double dt_s = std::max(seconds_between(before_ns, imu.sensor_time_ns), 0.0);
    ahrs.update(settings, measurement_of(imu, dt_s));
    before_ns = imu.sensor_time_ns;
    since_start_s += dt_s;
    if (since_start_s + 1e-6 < next_print_s) continue;
    print_outputs(since_start_s, ahrs, imu);
    print_condition(ahrs, settings);
    next_print_s += 1.0;
  }
  const Vector3d offset_dps = ahrs.gyro_bias_body_radps() / geometry::radians_per_degree;
  std::printf("gyroscope offset %.2f deg/s\n", offset_dps.norm());
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
