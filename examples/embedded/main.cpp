// The engine in a program of its own, without DDS: an IMU at rest and fixes in, poses out. Prints the pose
// once a second.

#include <sonopose/estimation/any_estimator.hpp>

#include <iostream>

int main() {
  using namespace sonopose;
  const settings::Settings settings;
  estimation::AnyEstimator estimator(settings);

  const Vector3d position_world_m(2.0, 1.0, 0.5);
  const TimeNs start_ns = 1'700'000'000'000'000'000;  // since the Unix epoch
  for (int i = 0; i <= 1000; ++i) {                   // 10 s at 100 Hz
    ImuSample imu;
    imu.sensor_time_ns = start_ns + to_ns(0.01 * i);
    imu.specific_force_body_mps2 = {0.0, 0.0, standard_gravity_mps2};
    const auto pose = estimator.predict(imu);
    if (pose && i % 100 == 0) {
      std::cout << seconds_between(start_ns, pose->time_ns) << " s: " << pose->position_world_m.transpose()
                << ", ± " << position_std_m(*pose).transpose() << " m, status " << pose->status << '\n';
    }
    if (i == 0 || i % 12 != 0) continue;  // a fix at 8 Hz, after the IMU samples that came before it
    UltrasonicFix fix;
    fix.received_time_ns = imu.sensor_time_ns;
    fix.measured_delay_s = 0.07;  // otherwise delay.processing_s applies
    fix.emission_time_ns = fix.received_time_ns - to_ns(*fix.measured_delay_s);
    fix.position_world_m = position_world_m;
    estimator.correct(fix);
  }
}
