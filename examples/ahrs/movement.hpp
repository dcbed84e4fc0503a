#pragma once
/// \file
/// Samples for the examples, from a log or from a built-in movement.

#include "recording/log_folder.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <vector>

namespace example {

/// 90 s at 100 Hz in a world of X east, Y north, Z up. The body faces north; its gyroscope has an offset of
/// 0.5 deg/s.
///    0…60 s  at rest
///   60…63 s  rolls by 30° and stays there
///   65…67 s  accelerates north at 1 m/s²
///   70…78 s  a nearby magnet turns the field by 90°
inline std::vector<sonopose::ImuSample> built_in_movement() {
  using namespace sonopose;
  const double degree = geometry::radians_per_degree;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 9000; ++i) {
    const double t = 0.01 * i;
    const bool rolls = t > 60.0 && t <= 63.0;
    const bool pushed = t > 65.0 && t <= 67.0;
    const bool magnet = t > 70.0 && t <= 78.0;
    const double roll_rad = 10.0 * degree * std::clamp(t - 60.0, 0.0, 3.0);
    const Quaterniond q = geometry::rotation_about_z(90.0 * degree) * geometry::rotation_by({roll_rad, 0, 0});
    ImuSample sample;
    sample.sensor_time_ns = 1'700'000'000'000'000'000 + to_ns(t);
    sample.angular_velocity_body_radps = {rolls ? 10.0 * degree : 0.0, 0.0, 0.5 * degree};
    sample.specific_force_body_mps2 =
        q.conjugate() * Vector3d(0.0, pushed ? 1.0 : 0.0, standard_gravity_mps2);
    sample.magnetic_field_body_t =
        q.conjugate() * (magnet ? Vector3d(-20e-6, 0.0, -45e-6) : Vector3d(0.0, 20e-6, -45e-6));
    samples.push_back(sample);
  }
  return samples;
}

/// Samples of the imu.csv in the first argument, otherwise of the built-in movement.
inline std::vector<sonopose::ImuSample> samples(int argc, char** argv) {
  if (argc > 1) return sonopose::recording::read_imu_csv(argv[1], sonopose::recording::default_log_address);
  return built_in_movement();
}

}  // namespace example
