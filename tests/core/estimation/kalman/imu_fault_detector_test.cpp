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

SCENARIO("the mean of the innovations shows a constant error far below that of one innovation") {
  Innovation innovation;
  innovation.covariance_m2 = std_m * std_m * Matrix3d::Identity();
  ImuFaultDetector detector;
  GIVEN("innovations of one standard deviation to alternating sides") {
    for (int i = 0; i < 100; ++i) {
      innovation.value_world_m = Vector3d::Constant(i % 2 == 0 ? std_m : -std_m);
      detector.add_used(innovation);
    }
    THEN("their mean is zero within a standard deviation") {
      CHECK(detector.mean_innovation_chi2 < 1.0);
    }
  }
  GIVEN("innovations of one standard deviation to one side") {
    innovation.value_world_m = Vector3d::Constant(std_m);
    for (int i = 0; i < 100; ++i) detector.add_used(innovation);
    THEN("the mean is theirs, three standard deviations of a mean of nine per axis") {
      CHECK((detector.mean_innovation_world_m - innovation.value_world_m).norm() < 1e-6);
      CHECK(detector.mean_innovation_chi2 == Approx(3.0 * 9.0).epsilon(0.001));
    }
  }
}

}  // namespace kalman_imu_fault_detector_test
