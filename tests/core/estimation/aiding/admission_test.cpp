/// Admission: item 12, and values that no sensor can have measured.

#include <sonopose/samples/time_jump.hpp>

#include <catch2/catch.hpp>

#include <limits>
#include <support/engine_driver.hpp>

namespace admission_test {

using namespace sonopose;
using namespace sonopose::estimation;
using namespace sonopose::estimation::aiding;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::epoch_ns;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

UltrasonicFix good_fix() {
  UltrasonicFix fix;
  fix.emission_time_ns = epoch_ns - to_ns(0.068);
  fix.received_time_ns = epoch_ns;
  fix.position_world_m = {1, 2, 3};
  fix.quality_percent = 80.0;
  return fix;
}

std::uint32_t flags_of(const UltrasonicFix& fix, AdmissionState state = {}) {
  return admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, fix, fix.emission_time_ns);
}

TEST_CASE("item 12: a fix below the least quality is kept out, one at it is not") {
  UltrasonicFix fix = good_fix();
  fix.quality_percent = AdmissionSettings{}.min_quality_percent;
  CHECK(flags_of(fix) == 0);
  fix.quality_percent = AdmissionSettings{}.min_quality_percent - 0.1;
  CHECK(flags_of(fix) == fix_low_quality);
  fix.quality_percent = not_a_number;
  CHECK(flags_of(fix) == fix_low_quality);
  fix.quality_percent = std::nullopt;
  CHECK(flags_of(fix) == 0);
}

TEST_CASE("item 12: a fix of low quality changes nothing but a counter and its report") {
  const auto drive = [](bool with_bad_fixes) {
    test::EngineDriver driver(Settings{}, test::departure(2.0, 0.1));
    int count = 0;
    driver.run(4.0);
    driver.alter_fix = [&count, with_bad_fixes](UltrasonicFix& fix, double) {
      if (++count % 3 != 0) return;
      fix.position_world_m += Vector3d(4, 5, 6);
      fix.quality_percent = 10.0;
      // The same gap in the good fixes, made by one that no engine accepts.
      if (!with_bad_fixes) fix.position_world_m.x() = not_a_number;
    };
    driver.run(4.0);
    return driver;
  };
  const test::EngineDriver with = drive(true);
  const test::EngineDriver without = drive(false);
  REQUIRE(with.moments.size() == without.moments.size());
  for (std::size_t i = 0; i < with.moments.size(); ++i) {
    REQUIRE(with.moments[i].pose.position_world_m == without.moments[i].pose.position_world_m);
    REQUIRE(with.moments[i].pose.velocity_world_mps == without.moments[i].pose.velocity_world_mps);
    REQUIRE(with.moments[i].pose.status == without.moments[i].pose.status);
  }
  CHECK(with.engine.counters().fixes_rejected >= 15);
  int reported = 0;
  for (const FixReport& report : with.reports) reported += report.flags == fix_low_quality ? 1 : 0;
  CHECK(reported == static_cast<int>(with.engine.counters().fixes_rejected));
}

TEST_CASE("a fix that cannot be a measurement of this time is invalid") {
  UltrasonicFix fix = good_fix();
  SECTION("coordinates that are no numbers") {
    for (const double bad : {not_a_number, infinite, -infinite, 2e4}) {
      for (int axis = 0; axis < 3; ++axis) {
        fix = good_fix();
        fix.position_world_m[axis] = bad;
        CHECK(flags_of(fix) == fix_invalid);
      }
    }
  }
  SECTION("from the future, beyond what an IMU sample may still be under way") {
    fix.emission_time_ns = epoch_ns + to_ns(1.0);
    fix.received_time_ns = fix.emission_time_ns + to_ns(0.068);
    CHECK(flags_of(fix) == fix_invalid);
  }
  SECTION("received before it was emitted, by more than clocks may differ, or absurdly long after") {
    fix.received_time_ns = fix.emission_time_ns - to_ns(0.29);
    CHECK(flags_of(fix) == 0);
    fix.received_time_ns = fix.emission_time_ns - to_ns(0.31);
    CHECK(flags_of(fix) == fix_invalid);
    fix.received_time_ns = 0;
    CHECK(flags_of(fix) == fix_invalid);
    fix.received_time_ns = epoch_ns + to_ns(1e6);
    CHECK(flags_of(fix) == fix_invalid);
  }
  SECTION("twice, or out of order") {
    AdmissionState state;
    CHECK(admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, fix, fix.emission_time_ns) == 0);
    CHECK(admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, fix, fix.emission_time_ns) ==
          fix_invalid);
    fix.emission_time_ns -= to_ns(0.05);
    CHECK(admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, fix, fix.emission_time_ns) ==
          fix_invalid);
  }
  SECTION("before there is any time to compare it with") {
    AdmissionState state;
    CHECK(admission::rejection_flags(AdmissionSettings{}, state, 0, fix, fix.emission_time_ns) ==
          fix_invalid);
  }
}

TEST_CASE("a fix that is older than the limit is too late, which is not the same as invalid") {
  const TimeNs limit_ns = to_ns(AdmissionSettings{}.max_fix_age_s);
  UltrasonicFix fix = good_fix();
  fix.emission_time_ns = epoch_ns - limit_ns - 1'000'000;
  CHECK(flags_of(fix) == fix_too_late);
  SECTION("at the limit it is not too late") {
    fix.emission_time_ns = epoch_ns - limit_ns;
    CHECK(flags_of(fix) == 0);
  }
  SECTION("whatever its order and its quality") {
    fix.quality_percent = 1.0;
    CHECK(flags_of(fix, {.last_fix_measured_ns = epoch_ns}) == fix_too_late);
  }
  SECTION("unless it cannot be a measurement at all") {
    fix.position_world_m.x() = not_a_number;
    CHECK(flags_of(fix) == fix_invalid);
    fix = good_fix();
    fix.emission_time_ns = epoch_ns - to_ns(2.0);
    fix.received_time_ns = fix.emission_time_ns - 1;
    CHECK(flags_of(fix) == fix_invalid);
    fix.emission_time_ns = 0;
    CHECK(flags_of(fix) == fix_invalid);
  }
  SECTION("and it leaves the order of the others as it is") {
    AdmissionState state;
    CHECK(admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, fix, fix.emission_time_ns) ==
          fix_too_late);
    CHECK(state == AdmissionState{});
  }
}

TEST_CASE("a rejected fix is not remembered: the next good one is in order") {
  AdmissionState state;
  UltrasonicFix late = good_fix();
  late.emission_time_ns += to_ns(0.02);
  late.quality_percent = 5.0;
  CHECK(admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, late, late.emission_time_ns) ==
        fix_low_quality);
  CHECK(admission::rejection_flags(AdmissionSettings{}, state, epoch_ns, good_fix(),
                                   good_fix().emission_time_ns) == 0);
}

TEST_CASE("an IMU sample that cannot be a measurement is not admitted") {
  const AdmissionSettings settings;
  const ImuSample good = test::imu_on(test::Truth{}, epoch_ns);
  CHECK(admission::admits(settings, 0, good));
  CHECK(admission::admits(settings, epoch_ns, good));  // equal stamps of a coarse clock
  CHECK_FALSE(admission::admits(settings, epoch_ns + 1, good));
  for (const double bad : {not_a_number, infinite, 1e5, -1e5}) {
    ImuSample imu = good;
    imu.angular_velocity_body_radps.y() = bad;
    CHECK_FALSE(admission::admits(settings, 0, imu));
    imu = good;
    imu.specific_force_body_mps2.z() = bad;
    CHECK_FALSE(admission::admits(settings, 0, imu));
  }
  for (const TimeNs no_time :
       {TimeNs{0}, std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max()}) {
    ImuSample timeless = good;
    timeless.sensor_time_ns = no_time;
    CHECK_FALSE(admission::admits(settings, 0, timeless));
  }
  ImuSample forceless = good;  // no accelerometer reads exactly zero
  forceless.specific_force_body_mps2.setZero();
  CHECK_FALSE(admission::admits(settings, 0, forceless));
}

TEST_CASE("a sample far ahead is believed when those after it confirm it") {
  AdmissionState state;
  const auto sudden = [&state](double ahead_s) {
    return admission::is_time_jump(state, epoch_ns, test::imu_on(test::Truth{}, epoch_ns + to_ns(ahead_s)));
  };
  CHECK_FALSE(sudden(0.01));
  CHECK_FALSE(sudden(1.9));
  GIVEN("one broken stamp") {
    CHECK(sudden(1000.0));
    THEN("the samples after it go on as if it had not been") {
      CHECK_FALSE(sudden(0.02));
      CHECK(sudden(1000.0));  // the first broken stamp does not confirm the next one
    }
  }
  GIVEN("nine broken stamps in a row") {
    for (int i = 0; i < max_ahead_samples; ++i) CHECK(sudden(1000.0 + 0.01 * i));
    THEN("the samples after them go on as if they had not been") {
      CHECK_FALSE(sudden(0.1));
      CHECK(sudden(1000.0));
    }
  }
  GIVEN("a silence of five minutes") {
    for (int i = 0; i < max_ahead_samples; ++i) CHECK(sudden(300.0 + 0.01 * i));
    THEN("the tenth sample after it ends it") {
      CHECK_FALSE(sudden(300.09));
    }
  }
}

TEST_CASE("a heading that cannot be a measurement of this time is not admitted") {
  const AdmissionSettings settings;
  const PairHeading good{7, 1, epoch_ns - to_ns(0.068), epoch_ns, 0.3, true};
  CHECK(admission::admits(settings, epoch_ns, good, good.emission_time_ns));
  PairHeading heading = good;
  heading.heading_world_rad = not_a_number;
  CHECK_FALSE(admission::admits(settings, epoch_ns, heading, heading.emission_time_ns));
  heading = good;
  heading.emission_time_ns = epoch_ns + to_ns(1.0);
  CHECK_FALSE(admission::admits(settings, epoch_ns, heading, heading.emission_time_ns));
  heading = good;
  heading.received_time_ns = epoch_ns + to_ns(1e6);  // would be valid for eleven days
  CHECK_FALSE(admission::admits(settings, epoch_ns, heading, heading.emission_time_ns));
}

TEST_CASE("stamps from the far future, or a clock set back, does not stop the poses for good") {
  Engine engine{Settings{}};
  const auto sample_at = [](TimeNs time_ns) {
    ImuSample imu;
    imu.sensor_time_ns = time_ns;
    imu.specific_force_body_mps2 = {0.0, 0.0, test::gravity_mps2};
    return imu;
  };
  constexpr TimeNs step_ns = 10'000'000;
  constexpr TimeNs hour_ns = 3'600'000'000'000;
  TimeNs now_ns = test::epoch_ns;
  for (int i = 0; i < 200; ++i, now_ns += step_ns) REQUIRE(engine.predict(sample_at(now_ns)));
  for (int i = 0; i < max_ahead_samples; ++i)
    REQUIRE_FALSE(engine.predict(sample_at(now_ns + hour_ns + i * step_ns)));
  REQUIRE(engine.predict(sample_at(now_ns + hour_ns + max_ahead_samples * step_ns)));  // they confirm it

  int without_pose = 0;
  while (!engine.predict(sample_at(now_ns)) && without_pose < 1000) {
    ++without_pose;
    now_ns += step_ns;
  }
  CHECK(without_pose <= 100);  // at most one second
  CHECK(engine.reset_counter() == 1);
  CHECK(engine.counters().samples_invalid == static_cast<std::uint64_t>(without_pose + max_ahead_samples));
  CHECK(engine.predict(sample_at(now_ns + step_ns)));
}

}  // namespace admission_test
