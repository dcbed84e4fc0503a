/// Delay of the fixes (item 6): extrapolation from the time of measurement to the present.

#include <sonopose/estimation/aiding/delay.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace delay_test {

using namespace sonopose;
using namespace sonopose::estimation;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::epoch_ns;

UltrasonicFix fix_with(double age_s, std::optional<double> own_delay_s) {
  UltrasonicFix fix;
  fix.emission_time_ns = epoch_ns - to_ns(age_s);
  fix.received_time_ns = epoch_ns - to_ns(0.004);  // the IMU is 4 ms ahead of the receipt
  fix.position_world_m = {10, 20, 1};
  fix.measured_delay_s = own_delay_s;
  return fix;
}

DelaySettings settings_with(bool extrapolate, DelaySource source) {
  DelaySettings settings;
  settings.extrapolate = extrapolate;
  settings.source = source;
  return settings;
}

TEST_CASE("item 6: the delay is the fix's own or the fixed one") {
  const UltrasonicFix own = fix_with(0.104, 0.100);
  const UltrasonicFix none = fix_with(0.104, std::nullopt);
  const TimeNs by_fixed_ns = own.received_time_ns - to_ns(0.068);
  CHECK(aiding::measured_at(settings_with(true, DelaySource::measured), own) == own.emission_time_ns);
  CHECK(aiding::measured_at(settings_with(true, DelaySource::measured), none) == by_fixed_ns);
  CHECK(aiding::measured_at(settings_with(true, DelaySource::fixed), own) == by_fixed_ns);
  // The correction adds to the delay that a fix carries.
  DelaySettings corrected = settings_with(true, DelaySource::measured);
  corrected.correction_s = 0.02;
  CHECK(aiding::measured_at(corrected, own) == own.emission_time_ns - 20'000'000);
  CHECK(aiding::measured_at(corrected, none) == by_fixed_ns);
}

TEST_CASE("item 6: a fix is extrapolated to the time of the engine's state, not to its receipt") {
  const Vector3d velocity(6, -1, 0);
  const auto body = test::moving_body(velocity);
  const UltrasonicFix fix = fix_with(0.104, 0.100);
  const TimedFix timed = delay::extrapolated(settings_with(true, DelaySource::measured), body, fix);
  CHECK(timed.measured_position_world_m == fix.position_world_m);
  CHECK((timed.shifted_position_world_m - fix.position_world_m - 0.104 * velocity).norm() < 1e-9);

  const TimedFix still = delay::extrapolated(settings_with(false, DelaySource::measured), body, fix);
  CHECK(still.shifted_position_world_m == fix.position_world_m);
}

TEST_CASE("item 6: a correction of the velocity applies to the past as well") {
  auto body = test::moving_body({5, 0, 0});
  body.correct_velocity({1, 0, 0});
  const TimedFix timed =
      delay::extrapolated(settings_with(true, DelaySource::measured), body, fix_with(0.1, 0.096));
  CHECK((timed.shifted_position_world_m - Vector3d(10.6, 20, 1)).norm() < 1e-9);
}

TEST_CASE("item 6: in a turn it follows the path, not the tangent") {
  // A circle of 5 m at 6 m/s: over 0.1 s the chord and the current tangent differ by 3.6 cm.
  const test::Motion circle = test::departure(6.0, 0.2, -100.0, 1.0);
  Kinematics body;
  body.time_ns = epoch_ns;
  for (int i = -100; i <= 0; ++i) {
    body.displacement_world_m = circle(0.01 * i).position_world_m;
    body.history.push({epoch_ns + to_ns(0.01 * i), body.displacement_world_m, 0.0});
  }
  body.velocity_world_mps = circle(0.0).velocity_world_mps;
  UltrasonicFix fix = fix_with(0.1, 0.096);
  fix.position_world_m = circle(-0.1).position_world_m;
  const TimedFix timed = delay::extrapolated(settings_with(true, DelaySource::measured), body, fix);
  CHECK((timed.shifted_position_world_m - circle(0.0).position_world_m).norm() < 1e-6);
}

TEST_CASE("item 6: without a path it uses the present velocity") {
  auto body = test::moving_body({2, 0, 0});
  body.history.clear();
  const TimedFix timed =
      delay::extrapolated(settings_with(true, DelaySource::measured), body, fix_with(0.1, 0.096));
  CHECK((timed.shifted_position_world_m - Vector3d(10.2, 20, 1)).norm() < 1e-9);
}

TEST_CASE("item 6: at constant speed the output does not lag and does not step backward") {
  constexpr double speed_mps = 6.0;
  // The departure's acceleration, taken for gravity, tilts the attitude; the tilt decays with 1/kp = 7 s.
  constexpr double steady_s = 40.0;
  const auto drive = [](bool extrapolate) {
    Settings settings;
    settings.delay.extrapolate = extrapolate;
    test::EngineDriver driver(settings, test::departure(speed_mps));
    driver.run(steady_s + 5.0);
    return driver;
  };
  GIVEN("extrapolation on") {
    const test::EngineDriver driver = drive(true);
    THEN("the lag stays below 2 cm and the way goes only forward") {
      CHECK(test::worst_error_m(driver.moments, steady_s) < 0.02);
      double last_x = -1.0;
      for (const auto& moment : driver.moments) {
        if (moment.time_s < steady_s) continue;
        REQUIRE(moment.pose.position_world_m.x() > last_x);
        last_x = moment.pose.position_world_m.x();
      }
    }
    THEN("no fix makes a step back") {
      REQUIRE(seconds_between(epoch_ns, driver.reports.back().applied_time_ns) > steady_s + 4.0);
      for (const FixReport& report : driver.reports) {
        if (seconds_between(epoch_ns, report.applied_time_ns) > steady_s) {
          REQUIRE(report.jump_world_m.x() > -0.002);
        }
      }
    }
  }
  GIVEN("extrapolation off") {
    const test::EngineDriver driver = drive(false);
    THEN("it lags by about v × delay") {
      double lag_m = 0.0;
      int count = 0;
      for (const auto& moment : driver.moments) {
        if (moment.time_s < steady_s) continue;
        lag_m += moment.truth.position_world_m.x() - moment.pose.position_world_m.x();
        ++count;
      }
      CHECK(lag_m / count == Approx(speed_mps * 0.068).epsilon(0.15));
      // The exact lag: the distance driven from the emission to the time of the state that the fix was
      // applied to.
      const auto& last = driver.reports.back();
      CHECK(lag_m / count ==
            Approx(speed_mps * seconds_between(last.emission_time_ns, last.applied_time_ns)).epsilon(0.02));
    }
  }
}

TEST_CASE("item 6: a fix with its own, longer delay is extrapolated by that one") {
  test::Sensors sensors;
  sensors.delay_s = 0.150;
  const auto lag_m = [&sensors](DelaySource source) {
    Settings settings;
    settings.delay.source = source;
    test::EngineDriver driver(settings, test::departure(4.0), sensors);
    driver.run(45.0);
    return test::worst_error_m(driver.moments, 40.0);
  };
  CHECK(lag_m(DelaySource::measured) < 0.02);
  // 82 ms of the delay are not compensated.
  CHECK(lag_m(DelaySource::fixed) == Approx(4.0 * 0.082).epsilon(0.2));
}

}  // namespace delay_test
