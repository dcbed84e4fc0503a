// Orientation from gyroscope and accelerometer. The argument is an imu.csv; without it a built-in movement is
// used. Prints roll, pitch and yaw every 5 s.

#include "movement.hpp"
#include <sonopose/attitude/ahrs.hpp>

#include <cstdio>
#include <exception>

namespace {

void print(double time_s, const sonopose::Quaterniond& q_body_to_world) {
  const auto angles = sonopose::geometry::euler_angles_of(q_body_to_world);
  constexpr double degree = sonopose::geometry::radians_per_degree;
  std::printf("%6.1f s  roll %6.1f deg  pitch %6.1f deg  yaw %6.1f deg\n", time_s, angles.roll_rad / degree,
              angles.pitch_rad / degree, angles.yaw_rad / degree);
}

}  // namespace

int main(int argc, char** argv) try {
  using namespace sonopose;
  const std::vector<ImuSample> samples = example::samples(argc, argv);

  const attitude::AhrsSettings settings;
  attitude::Ahrs ahrs;
  TimeNs before_ns = samples.empty() ? 0 : samples.front().sensor_time_ns;
  double since_start_s = 0.0;
  double next_print_s = 0.0;
  for (const ImuSample& imu : samples) {
    attitude::Measurement<double> measurement;
    measurement.dt_s = std::max(seconds_between(before_ns, imu.sensor_time_ns), 0.0);
    measurement.angular_velocity_body_radps = imu.angular_velocity_body_radps;
    measurement.specific_force_body_mps2 = imu.specific_force_body_mps2;
    ahrs.update(settings, measurement);
    before_ns = imu.sensor_time_ns;
    since_start_s += measurement.dt_s;
    if (since_start_s + 1e-6 < next_print_s) continue;
    print(since_start_s, ahrs.orientation());
    next_print_s += 5.0;
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
