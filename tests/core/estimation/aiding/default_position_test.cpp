#include <sonopose/estimation/aiding/default_position.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace default_position_test {

using namespace sonopose;
using estimation::aiding::DefaultPosition;

const Vector3d origin = Vector3d::Zero();

/// Position of a walking body at fix `i`; ten fixes per second.
Vector3d walked_m(int i) {
  return {3.0 + 0.1 * i, 2.0 + 0.003 * (i % 3), 1.0};
}

TimeNs time_ns(int i) {
  return TimeNs{100'000'000} * (i + 1);
}

SCENARIO("a position that the fixes leave and return to exactly is a default one") {
  GIVEN("a walk") {
    DefaultPosition position;
    for (int i = 0; i < 3; ++i) REQUIRE_FALSE(position.add(time_ns(i), walked_m(i)));
    WHEN("the fixes are at the origin once") {
      THEN("that may be a single wrong fix") {
        CHECK_FALSE(position.add(time_ns(3), origin));
      }
    }
    WHEN("they come back to it") {
      position.add(time_ns(3), origin);
      position.add(time_ns(4), walked_m(4));
      const bool is_default = position.add(time_ns(5), origin);
      THEN("it is the default position, also from then on") {
        CHECK(is_default);
        CHECK_FALSE(position.add(time_ns(6), walked_m(6)));
        CHECK(position.add(time_ns(7), origin));
        CHECK(position.is_active(time_ns(8)));
      }
      AND_WHEN("it was not reported for a minute") {
        for (int i = 6; i < 610; ++i) position.add(time_ns(i), walked_m(i));
        THEN("it is one like any other") {
          CHECK_FALSE(position.is_active(time_ns(610)));
          CHECK_FALSE(position.add(time_ns(610), origin));
        }
      }
      AND_WHEN("twenty fixes in a row are there") {
        for (int i = 6; i < 25; ++i) position.add(time_ns(i), origin);
        THEN("the body is there") {
          CHECK_FALSE(position.add(time_ns(25), origin));
        }
      }
    }
  }
  GIVEN("a body at rest, whose fixes repeat to the millimetre") {
    DefaultPosition position;
    THEN("no fix is a default position") {
      for (int i = 0; i < 50; ++i) {
        CHECK_FALSE(position.add(time_ns(i), {1.0, 2.0, 0.001 * (i % 3)}));
      }
    }
  }
}

SCENARIO("an engine does not follow the position that a source reports where it has none") {
  GIVEN(
      "a body that drives away 5 m beside the origin, and a source that reports the origin for each third "
      "fix") {
    constexpr double noise_m = 0.02;
    const test::Motion drive = [away = test::departure(1.3)](double time_s) {
      test::Truth truth = away(time_s);
      truth.position_world_m.y() += 5.0;
      return truth;
    };
    test::EngineDriver driver({}, drive, test::with_headings(noise_m));
    const int first = GENERATE(0, 1, 2);  // with 0 the run starts at the origin
    CAPTURE(first);
    int fixes = 0;
    driver.alter_fix = [&](UltrasonicFix& fix, double /*time_s*/) {
      if (fixes++ % 3 == first) fix.position_world_m = origin;
    };
    WHEN("it drives for half a minute") {
      const auto last = driver.run(30.0);
      THEN("the error of the pose is that of the good fixes, no default is used, and the status says why") {
        CHECK(test::worst_error_m(driver.moments, 4.0) < 6.0 * noise_m);
        CHECK(last.has(status_fixes_inconsistent));
        CHECK_FALSE(last.has(status_stale));
        int defaults = 0;
        for (const FixReport& report : driver.reports) {
          if (report.position_world_m != origin || report.applied_time_ns < test::EngineDriver::stamp(1.0))
            continue;
          CHECK((report.flags & fix_used) == 0);
          ++defaults;
        }
        CHECK(defaults > 50);
      }
      AND_WHEN("the source has a solution again") {
        driver.alter_fix = nullptr;
        THEN("the status soon forgets it") {
          CHECK_FALSE(driver.run(4.0).has(status_fixes_inconsistent));
        }
      }
    }
  }
}

}  // namespace default_position_test
