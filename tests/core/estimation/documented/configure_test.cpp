/// Settings changed while the engine runs: it continues from its state.

#include "support/bits.hpp"
#include "support/engine_driver.hpp"
#include <sonopose/settings/preset.hpp>

#include <catch2/catch.hpp>

#include <numbers>

namespace configure_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::EngineDriver;

TEST_CASE("the same settings again change no bit") {
  Settings settings;
  settings.trust.sigma_m = 0.1;
  EngineDriver left_alone(settings, test::departure(2.0, 0.2), test::with_headings(0.02));
  EngineDriver configured(settings, test::departure(2.0, 0.2), test::with_headings(0.02));
  left_alone.run(6.0);
  configured.run(6.0);
  configured.engine.configure(settings);
  left_alone.run(6.0);
  configured.run(6.0);
  REQUIRE(left_alone.moments.size() == configured.moments.size());
  for (std::size_t i = 0; i < left_alone.moments.size(); ++i) {
    REQUIRE(test::bits_of(left_alone.moments[i].pose) == test::bits_of(configured.moments[i].pose));
  }
}

TEST_CASE("item 5: a later change of the mount offset turns the pose and does not move it") {
  const Vector3d place(5, -3, 2);
  EngineDriver driver(Settings{}, test::at_rest(place), test::with_headings());
  driver.run(10.0);
  const double yaw_before_rad = geometry::yaw_of(driver.moments.back().pose.q_body_to_world);
  Settings turned;
  turned.heading.mount_offset_deg = 90.0;
  driver.engine.configure(turned);
  const std::size_t since = driver.moments.size();
  driver.run(20.0);
  const double turn_rad =
      geometry::wrap_angle(geometry::yaw_of(driver.moments.back().pose.q_body_to_world) - yaw_before_rad);
  CHECK(std::abs(turn_rad) == Approx(std::numbers::pi / 2).margin(0.05));
  for (std::size_t i = since; i < driver.moments.size(); ++i) {
    const FusedPose& pose = driver.moments[i].pose;
    REQUIRE(pose.reset_counter == 0);
    REQUIRE_FALSE(driver.moments[i].has(status_initialising));
    REQUIRE((pose.position_world_m - place).norm() < 0.05);
  }
}

TEST_CASE("item 12: a raised quality limit applies from the next fix on") {
  EngineDriver driver(Settings{}, test::at_rest(), {});  // its fixes have a quality of 90 %
  driver.run(5.0);
  const EstimatorCounters before = driver.engine.counters();
  CHECK(before.fixes_used > 50);
  Settings strict;
  strict.admission.min_quality_percent = 95.0;
  driver.engine.configure(strict);
  driver.run(5.0);
  CHECK(driver.engine.counters().fixes_used == before.fixes_used);
  CHECK(driver.engine.counters().fixes_rejected > before.fixes_rejected + 50);
  CHECK(driver.engine.counters().imu_samples == before.imu_samples + 500);
}

TEST_CASE("item 1: a later preset is resolved, and `user` restores the user's values") {
  Engine engine{Settings{}};
  Settings settings;
  settings.drift.jump_alpha = 0.77;
  settings.preset.imu_weight = ImuWeight::high;
  engine.configure(settings);
  CHECK(engine.settings().drift.jump_alpha == balance_of(ImuWeight::high).jump_alpha);
  CHECK(engine.settings().velocity.blend_weight == balance_of(ImuWeight::high).blend_weight);
  settings.preset.imu_weight = ImuWeight::user;
  engine.configure(settings);
  CHECK(engine.settings().drift.jump_alpha == 0.77);
}

}  // namespace configure_test
