#include <sonopose/calibration/model/axes_check.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <optional>
#include <string>

namespace axes_check_test {

using namespace sonopose;
using namespace sonopose::calibration;
using Catch::Contains;

/// The problem of a drive whose specific force alternates about this mean.
std::optional<AxesProblem> problem_with(const Vector3d& mean_mps2, double duration_s = 6.0,
                                        const Settings& settings = {}) {
  AxesCheck check(settings);
  for (int i = 0; i < 100.0 * duration_s; ++i) {
    ImuSample imu;
    imu.sensor_time_ns = 1'700'000'000'000'000'000 + i * 10'000'000LL;
    imu.specific_force_body_mps2 = mean_mps2 + Vector3d(i % 2 == 0 ? 2.0 : -2.0, 0.5, 0.0);
    check.on(imu);
  }
  return check.problem();
}

SCENARIO("gravity shows an IMU that is not mounted as the settings say") {
  GIVEN("an IMU whose Z axis is down, as that of an autopilot") {
    const Vector3d down_mps2(0.1, 0.2, -9.8);
    THEN("the setting that turns it upright is named, and mends it") {
      const auto problem = problem_with(down_mps2);
      REQUIRE(problem);
      CHECK_THAT(problem->text, Contains("along -z of the body instead of +z"));
      CHECK_THAT(problem->remedy, Contains("calibration.axes=+x-y-z;"));
      Settings settings;
      settings.axes.axes = static_cast<Axes>(1);  // +x-y-z
      CHECK_FALSE(problem_with(down_mps2, 6.0, settings));
      CHECK_THAT(problem_with({0, 0, 9.8}, 6.0, settings)->remedy, Contains("calibration.axes=+x+y+z;"));
    }
  }
  GIVEN("one on its side") {
    CHECK_THAT(problem_with({0, -9.8, 0})->remedy, Contains("calibration.axes=+x+z-y;"));
  }
  GIVEN("an upright one, also on a steep ramp") {
    CHECK_FALSE(problem_with({0, 0, 9.8}));
    CHECK_FALSE(problem_with({5.0, 0, 8.4}));
  }
  GIVEN("no vertical: another unit, no gravity, a body that tumbles, or little time") {
    CHECK_FALSE(problem_with({0, 0, -1.0}));
    CHECK_FALSE(problem_with({0, 0, -980.0}));
    CHECK_FALSE(problem_with({0, -3.0, 1.0}));
    CHECK_FALSE(problem_with({0, 0, -9.8}, 4.0));
  }
}

}  // namespace axes_check_test
