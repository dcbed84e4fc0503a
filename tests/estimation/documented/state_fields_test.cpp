/// An engine's state as a list of fields, and an engine that goes on from another one's.

#include <sonopose/estimation/documented/state_fields.hpp>

#include <catch2/catch.hpp>

#include <set>
#include <string>
#include <support/engine_driver.hpp>

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

TEST_CASE("every group of the state is walked over, and no field has another one's name") {
  const State state;
  std::multiset<std::string> names;
  for_each_field(state, [&](const char* name, const auto&) { names.insert(name); });
  for (const std::string& name : names) {
    if (name != "velocity.fixes") CHECK(names.count(name) == 1);
  }
  CHECK(names.count("velocity.fixes") == static_cast<std::size_t>(VelocityState::capacity));
  for (const char* const group :
       {"body.", "startup.", "admission.", "frozen.", "trust.", "drift.", "velocity.", "alignment.",
        "heading.", "outage.", "runaway.", "uncertainty."}) {
    CHECK(names.lower_bound(group) != names.end());
    CHECK(names.lower_bound(group)->starts_with(group));
  }
}

TEST_CASE("an engine that goes on from another one's snapshot makes the same bits") {
  GIVEN("a body on a bend, whose engine's snapshot a new engine takes over half way") {
    test::Sensors sensors;
    sensors.noise_m = 0.02;
    sensors.headings = true;
    const auto motion = test::departure(1.5, 0.3);
    test::EngineDriver whole(Settings{}, motion, sensors);
    test::EngineDriver handed_over(Settings{}, motion, sensors);
    whole.run(8.0);
    handed_over.run(8.0);
    const Snapshot half_way = handed_over.engine.snapshot();
    handed_over.engine = Engine(Settings{});
    REQUIRE_FALSE(handed_over.engine.snapshot() == half_way);
    handed_over.engine.restore(half_way);
    WHEN("both go on") {
      const auto expected = whole.run(5.0);
      const auto found = handed_over.run(5.0);
      THEN("pose, state and counters are equal") {
        CHECK(found.pose.position_world_m == expected.pose.position_world_m);
        CHECK(found.pose.q_body_to_world.coeffs() == expected.pose.q_body_to_world.coeffs());
        CHECK(handed_over.engine.snapshot() == whole.engine.snapshot());
        CHECK(whole.engine.counters().fixes_used > 100);
      }
    }
  }
}
