#include <sonopose/estimation/kalman/imu_fault_detector.hpp>

#include <catch2/catch.hpp>

namespace kalman_imu_fault_detector_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

constexpr double std_m = 0.02;

SCENARIO("which fixes form another track") {
  constexpr TimeNs interval_ns = 100'000'000;
  constexpr double wrong_below = -4.0;
  const Matrix3d noise_m2 = std_m * std_m * Matrix3d::Identity();
  ShiftedTrack shifted;
  GIVEN("an offset that jumps and stays") {
    shifted.add(interval_ns, Vector3d::Zero(), noise_m2);
    THEN("only the jump is unlikely") {
      CHECK(shifted.add(2 * interval_ns, {1.0, 0.0, 0.0}, noise_m2) < wrong_below);
      for (int i = 3; i < 20; ++i) {
        CHECK(shifted.add(i * interval_ns, {1.0, 0.0, 0.0}, noise_m2) > 0.0);
      }
    }
  }
  GIVEN("an offset that grows at 2 m/s²") {
    int unlikely = 0;
    for (int i = 1; i <= 20; ++i) {
      const double offset_m = 0.5 * 2.0 * (0.1 * i) * (0.1 * i);
      if (shifted.add(i * interval_ns, {offset_m, 0.0, 0.0}, noise_m2) < wrong_below) ++unlikely;
    }
    THEN("again and again it leaves the track") {
      CHECK(unlikely >= 4);
    }
  }
}

}  // namespace kalman_imu_fault_detector_test
