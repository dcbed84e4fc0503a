#include "fusion/twist_use.hpp"

#include <catch2/catch.hpp>

#include <cstdint>

namespace twist_use_test {

using namespace sonopose;
using Catch::Matchers::Contains;
using fusion::TwistUse;

settings::Settings settings_of(settings::EngineKind engine, bool is_enabled = true) {
  settings::Settings settings;
  settings.engine.engine = engine;
  settings.twist.enabled = is_enabled;
  return settings;
}

const settings::Settings kalman = settings_of(settings::EngineKind::kalman);
const settings::Settings documented = settings_of(settings::EngineKind::documented);

SCENARIO("the user learns what becomes of velocities") {
  TwistUse use;
  EstimatorCounters counted;
  GIVEN("an engine that uses none") {
    const auto count_messages = [&](const settings::Settings& settings, const char* cause) {
      int messages = 0;
      for (std::uint64_t i = 0; i < std::uint64_t{3} * TwistUse::max_unused_updates; ++i) {
        counted.twists_unused += 50;
        if (const auto text = use.update(counted, settings)) {
          CHECK_THAT(*text, Contains(cause));
          ++messages;
        }
      }
      return messages;
    };
    THEN("this is said once, with the cause") {
      CHECK(count_messages(documented, "the documented engine uses none") == 1);
    }
    THEN("the cause of the other engine is another one") {
      CHECK(count_messages(settings_of(settings::EngineKind::kalman, false),
                           "kalman.twist.enabled is false") == 1);
    }
  }
  GIVEN(
      "velocities that are newer than the IMU samples, of which the last one is sometimes counted as used") {
    THEN("this is said once, too") {
      int messages = 0;
      for (std::uint64_t i = 0; i < std::uint64_t{3} * TwistUse::max_unused_updates; ++i) {
        counted.twists_used = i % 2U;
        counted.twists_unused += 49U + (i + 1U) % 2U;
        if (const auto text = use.update(counted, kalman)) {
          CHECK_THAT(*text, Contains("newer than the IMU samples"));
          ++messages;
        }
      }
      CHECK(messages == 1);
    }
  }
  GIVEN("no velocities, or some that wait for the first fix") {
    THEN("nothing is said") {
      for (int i = 0; i < 100; ++i) CHECK_FALSE(use.update(counted, documented));
      counted.twists_unused += 50;
      CHECK_FALSE(use.update(counted, kalman));
      counted.twists_used += 50;
      CHECK_FALSE(use.update(counted, kalman));
    }
  }
  GIVEN("wheels that slip for a time") {
    counted.twists_used = 48;
    counted.twists_rejected = 2;
    CHECK_FALSE(use.update(counted, kalman));
    counted.twists_used += 10;
    counted.twists_rejected += 40;
    const auto begin = use.update(counted, kalman);
    counted.twists_rejected += 50;
    CHECK_FALSE(use.update(counted, kalman));
    counted.twists_used += 50;
    const auto end = use.update(counted, kalman);
    THEN("its beginning and its end are said") {
      REQUIRE(begin);
      CHECK_THAT(*begin, Contains("as when wheels slip: 40 of 50 are rejected; remedy: "));
      CHECK(end == "velocities agree with the estimate again");
    }
  }
}

}  // namespace twist_use_test
