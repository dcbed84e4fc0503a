/// Recordings that lack a motion: the calibration names what is missing and claims nothing.

#include "calibration/drive/drive_fit.hpp"
#include "calibration/drive/simulated_drive.hpp"
#include "sim/laps.hpp"
#include "sim/simulator.hpp"
#include "support/events.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace refusal_test {

using namespace sonopose;
using namespace sonopose::test;
using namespace sonopose::calibration::drive;
using Catch::Contains;

constexpr double short_drive_s = 45.0;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;  // a pass takes twenty times as long
#else
constexpr bool is_sanitized = false;
#endif

DriveFit calibrated(const std::vector<Event>& events) {
  const std::vector<std::vector<Event>> recordings{events};
  return calibrate_drive(recordings, settings::Settings{});
}

/// A run on this path with a nonzero mount and delay.
std::vector<Event> events_on(sim::Path (*path)(double time_s), std::uint64_t seed, double duration_s) {
  sim::Scenario scenario;
  scenario.path = path;
  scenario.sensors.pair_mount_offset_rad = 0.7;
  scenario.sensors.reported_delay_error_s = -0.03;
  return sim::record(scenario, {.seed = seed, .duration_s = duration_s}).events;
}

sim::Path at_rest(double /*time_s*/) {
  return {};
}

/// 1 m/s from the first sample, unaccelerated.
sim::Path at_constant_velocity(double time_s) {
  sim::Path path;
  path.x = sim::Jet(time_s, 1.0, 0.0);
  return path;
}

/// Straight to and fro between rests, without turning.
sim::Path straight_on(double time_s) {
  constexpr double lap_s = 6.0;
  sim::Path path;
  const double in_lap_s = sim::time_in_lap(time_s, lap_s);
  path.x = sim::drive(in_lap_s, 0.2, 1.5, 1.0, 0.8) - sim::drive(in_lap_s, 3.2, 1.5, 1.0, 0.8);
  return path;
}

SCENARIO("neither rest nor a constant velocity shows mount, delay and lever arm") {
  for (const auto path : {at_rest, at_constant_velocity}) {
    GIVEN(std::string(path == at_rest ? "a body at rest" : "a body at constant velocity")) {
      const std::vector<Event> events = events_on(path, 911, 20.0);
      WHEN("it is calibrated") {
        const DriveFit fit = calibrated(events);
        THEN("they are refused, with the motion that is missing; the noise of the fixes is known") {
          CHECK_THAT(fit[Quantity::mount].missing, Contains("accelerate"));
          CHECK_THAT(fit[Quantity::delay].missing, Contains("change speed"));
          CHECK_THAT(fit[Quantity::lever_arm_x].missing, Contains("turn"));
          CHECK_THAT(fit[Quantity::lever_arm_y].missing, Contains("turn"));
          CHECK_THAT(fit[Quantity::lever_arm_z].missing, Contains("tilt"));
          CHECK(fit[Quantity::fix_vertical].is_known());
        }
      }
    }
  }
}

SCENARIO("a drive without a turn shows the mount but no lever arm") {
  GIVEN("a body that accelerates and brakes along a line") {
    const std::vector<Event> events = events_on(straight_on, 912, 60.0);
    WHEN("it is calibrated") {
      const DriveFit fit = calibrated(events);
      THEN("the mount is right and the lever arm refused") {
        REQUIRE(fit[Quantity::mount].is_known());
        CHECK(fit[Quantity::mount].value == Approx(0.7).margin(1.5 * geometry::radians_per_degree));
        CHECK_THAT(fit[Quantity::lever_arm_x].missing, Contains("turn"));
        CHECK_THAT(fit[Quantity::lever_arm_y].missing, Contains("turn"));
      }
    }
  }
}

SCENARIO("a single beacon has no mount") {
  GIVEN("a walk without headings") {
    const SimulatedDrive drive = random_drive("no_heading", 913, short_drive_s);
    WHEN("it is calibrated") {
      const DriveFit fit = calibrated(drive.recordings.front());
      THEN("mount and noise of headings are refused, the delay is right") {
        CHECK_THAT(fit[Quantity::mount].missing, Contains("paired beacons"));
        CHECK_THAT(fit[Quantity::heading].missing, Contains("paired beacons"));
        REQUIRE(fit[Quantity::delay].is_known());
        CHECK(std::abs(error_of(drive, fit, Quantity::delay)) < 0.008);
      }
    }
  }
}

/// Arcs to and fro about one centre, at up to 2.4 m/s.
sim::Path on_one_circle(double time_s) {
  constexpr double lap_s = 8.0;
  constexpr double radius_m = 4.0;
  constexpr double way_rad = 1.2;
  const double in_lap_s = sim::time_in_lap(time_s, lap_s);
  const sim::Jet angle =
      sim::drive(in_lap_s, 0.2, way_rad, 0.6, 1.0) - sim::drive(in_lap_s, 4.2, way_rad, 0.6, 1.0);
  sim::Path path;
  path.x = sim::Jet{radius_m} * sin(angle);
  path.y = sim::Jet{-radius_m} * cos(angle);
  path.yaw = angle;
  return path;
}

SCENARIO("on one circle neither mount nor lever arm is observable, whatever the speed") {
  // An IMU that is moved about the centre and turned by the same angle measures the same.
  GIVEN("a body that drives to and fro on a circle") {
    const std::vector<Event> events = events_on(on_one_circle, 915, short_drive_s);
    WHEN("it is calibrated") {
      const DriveFit fit = calibrated(events);
      THEN("mount and lever arm are refused, the delay is right") {
        CHECK_THAT(fit[Quantity::mount].missing, Contains("on one circle"));
        CHECK_THAT(fit[Quantity::lever_arm_x].missing, Contains("turn"));
        REQUIRE(fit[Quantity::delay].is_known());
        CHECK(fit[Quantity::delay].value == Approx(0.03).margin(0.008));
      }
    }
  }
}

/// The log as a single beacon records it.
std::vector<Event> without_headings(std::vector<Event> events) {
  std::erase_if(events, [](const Event& event) { return std::holds_alternative<PairHeading>(event); });
  return events;
}

/// Delays the headings so far that no engine can use them.
std::vector<Event> with_late_headings(std::vector<Event> events) {
  constexpr TimeNs late_ns = 20'000'000'000;
  for (auto* heading : test::each<PairHeading>(events)) heading->received_time_ns += late_ns;
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return available_at_ns(a) < available_at_ns(b); });
  return events;
}

SCENARIO("the logs of one installation need not all have headings") {
  GIVEN("two drives, of which the second starts in another direction") {
    const std::vector<Event> first = random_drive("kart", 916, short_drive_s).recordings.front();
    const SimulatedDrive drive = random_drive("forklift", 916, short_drive_s);
    const std::vector<Event>& second = drive.recordings.front();
    for (const bool are_late : {false, true}) {
      if (is_sanitized && !are_late) continue;  // the missing headings exercise the same code
      WHEN(std::string("the headings of the second are ") +
           (are_late ? "refused by the engine" : "missing")) {
        const std::vector<std::vector<Event>> recordings{
            first, are_late ? with_late_headings(second) : without_headings(second)};
        const DriveFit fit = calibrate_drive(recordings, settings::Settings{});
        THEN("mount and delay are right, and all fixes count") {
          CHECK(fit.converged);
          REQUIRE(fit[Quantity::mount].is_known());
          REQUIRE(fit[Quantity::delay].is_known());
          CHECK(std::abs(error_of(drive, fit, Quantity::mount)) < geometry::radians_per_degree);
          CHECK(std::abs(error_of(drive, fit, Quantity::delay)) < 0.004);
          CHECK(static_cast<double>(fit.fixes_used) > 0.95 * static_cast<double>(fit.fixes));
          CHECK(fit.squared_fix_innovation == Approx(1.0).margin(0.15));
        }
      }
    }
  }
  GIVEN("one drive whose headings the engine refuses") {
    const SimulatedDrive drive = random_drive("forklift", 917, short_drive_s);
    WHEN("it is calibrated") {
      const DriveFit fit = calibrated(with_late_headings(drive.recordings.front()));
      THEN("the mount is refused with the reason, and the delay is right") {
        CHECK(fit.headings_used == 0);
        CHECK_THAT(fit[Quantity::mount].missing, Contains("none of them could be used"));
        REQUIRE(fit[Quantity::delay].is_known());
        CHECK(std::abs(error_of(drive, fit, Quantity::delay)) < 0.008);
      }
    }
  }
}

SCENARIO("a recording that is too short is refused") {
  GIVEN("three seconds") {
    const std::vector<Event> events = events_on(straight_on, 914, 3.0);
    THEN("the error says what was found and what is needed") {
      CHECK_THROWS_WITH(calibrated(events), Contains("are needed"));
    }
  }
}

}  // namespace refusal_test
