/// Calibration from real recordings, where present.

#include "support/recordings.hpp"

#include "calibration/drive/drive_fit.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

namespace recordings_test {

using namespace sonopose;
using namespace sonopose::calibration::drive;

constexpr double degree = geometry::radians_per_degree;

/// Events of a recording; empty if it is missing.
std::vector<std::vector<Event>> events_of(const std::string& name) {
  const auto folder = test::beacon_recordings(name);
  if (!test::is_here(folder)) return {};
  return {recording::read_sensor_log(folder).events};
}

SCENARIO("a recorded flight shows its mount and its delay") {
  for (const char* const name : {"drone_a", "drone_b"}) {
    GIVEN(std::string("the flight ") + name +
          ", whose fixes and headings were made with a mount of zero and true stamps") {
      const auto recordings = events_of(name);
      if (recordings.empty()) return;
      WHEN("it is calibrated") {
        const DriveFit fit = calibrate_drive(recordings, settings::Settings{});
        THEN(
            "mount and delay are near what was made, and little but the bursts of wrong fixes was left out") {
          CHECK(fit.mount_method == MountMethod::likelihood);
          REQUIRE(fit[Quantity::mount].is_known());
          REQUIRE(fit[Quantity::delay].is_known());
          CHECK(std::abs(fit[Quantity::mount].value) < 2.0 * degree);
          CHECK(std::abs(fit[Quantity::delay].value) < 0.012);
          CHECK(fit.fixes_used < fit.fixes);
          CHECK(static_cast<double>(fit.fixes_used) > 0.95 * static_cast<double>(fit.fixes));
        }
      }
    }
  }
}

SCENARIO("an IMU that contradicts the fixes does not spoil the mount") {
  GIVEN("the recorded car: a planar IMU with derived axes, and a pair about across its X axis") {
    const auto recordings = events_of("car");
    if (recordings.empty()) return;
    WHEN("it is calibrated") {
      const DriveFit fit = calibrate_drive(recordings, settings::Settings{});
      THEN(
          "the mount comes from the direction of travel, and its interval contains the angle of the pair; "
          "nothing else is claimed") {
        CHECK(fit.mount_method == MountMethod::course);
        const Value& mount = fit[Quantity::mount];
        REQUIRE(mount.is_known());
        CHECK(mount.value > 80.0 * degree);
        CHECK(mount.value < 92.0 * degree);
        CHECK(mount.low < 85.0 * degree);
        CHECK(mount.high > 85.0 * degree);
        CHECK_FALSE(fit[Quantity::delay].is_known());
        CHECK_FALSE(fit[Quantity::lever_arm_x].is_known());
        CHECK_FALSE(fit[Quantity::fix_horizontal].is_known());
      }
    }
  }
}

}  // namespace recordings_test
