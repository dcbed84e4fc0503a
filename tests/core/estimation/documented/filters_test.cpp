/// The engine with each attitude filter: in use, switched while running, saved and restored.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/documented/state_fields.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace filters_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using attitude::FilterKind;

constexpr std::size_t kinds = choices_of(FilterKind{}).size();

Settings with(FilterKind kind, bool magnetometer = false) {
  Settings settings;
  settings.attitude.selection.filter = kind;
  settings.attitude.selection.magnetometer = magnetometer;
  settings.attitude.selection.north_deg = 30.0;
  return settings;
}

/// Adds the magnetic field of a place whose north lies 30° from world X.
void add_field(ImuSample& imu, const test::Truth& truth) {
  const double north_rad = 30.0 * geometry::radians_per_degree;
  const Vector3d field_world_t(20e-6 * std::cos(north_rad), 20e-6 * std::sin(north_rad), -40e-6);
  imu.magnetic_field_body_t = geometry::rotation_about_z(-truth.yaw_rad) * field_world_t;
}

TEST_CASE("with each filter the pose follows a bend, with paired headings and with the magnetometer") {
  const auto motion = test::departure(1.5, 0.3);
  for (std::size_t i = 0; i < kinds; ++i) {
    for (const bool magnetometer : {false, true}) {
      INFO(choices_of(FilterKind{})[i] << (magnetometer ? " with" : " without") << " magnetometer");
      test::Sensors sensors;
      sensors.noise_m = 0.02;
      sensors.headings = !magnetometer;
      test::EngineDriver driver(with(static_cast<FilterKind>(i), magnetometer), motion, sensors);
      driver.alter_imu = [&](ImuSample& imu, double time_s) {
        if (magnetometer) add_field(imu, motion(time_s));
      };
      const auto moment = driver.run(15.0);
      CHECK(moment.position_error_m() < 0.10);
      const double yaw_off_rad =
          geometry::wrap_angle(geometry::yaw_of(moment.pose.q_body_to_world) - moment.truth.yaw_rad);
      // The gyro filter takes its heading from accelerations seen by the fixes, which are rare here.
      const bool no_heading = magnetometer && static_cast<FilterKind>(i) == FilterKind::gyro;
      CHECK(std::abs(yaw_off_rad) < (no_heading ? 0.3 : 0.05));
      CHECK(driver.engine.state().filter.kind() == static_cast<FilterKind>(i));
    }
  }
}

TEST_CASE("a running engine that changes its filter continues from the orientation of the previous one") {
  test::Sensors sensors;
  sensors.headings = true;
  test::EngineDriver driver(Settings{}, test::departure(1.5, 0.3), sensors);
  driver.run(8.0);
  for (const std::size_t i : {1U, 2U, 3U, 4U, 0U}) {
    driver.engine.configure(with(static_cast<FilterKind>(i)));
    const auto moment = driver.run(2.0);
    INFO(choices_of(FilterKind{})[i]);
    CHECK(driver.engine.state().filter.kind() == static_cast<FilterKind>(i));
    CHECK(moment.position_error_m() < 0.10);
    CHECK(std::abs(geometry::up_in_body(moment.pose.q_body_to_world).z()) > std::cos(0.02));
  }
}

TEST_CASE("each filter continues from another engine's snapshot with the same bits") {
  for (std::size_t i = 0; i < kinds; ++i) {
    const Settings settings = with(static_cast<FilterKind>(i));
    const auto motion = test::departure(1.5, 0.3);
    test::EngineDriver whole(settings, motion, {});
    test::EngineDriver handed_over(settings, motion, {});
    whole.run(6.0);
    handed_over.run(6.0);
    const Snapshot half_way = handed_over.engine.snapshot();
    handed_over.engine = Engine(settings);
    handed_over.engine.restore(half_way);
    whole.run(2.0);
    handed_over.run(2.0);
    INFO(choices_of(FilterKind{})[i]);
    CHECK(handed_over.engine.snapshot() == whole.engine.snapshot());
  }
}

TEST_CASE("a long curve without fixes does not tilt the default filter within documented.alignment.hold_s") {
  // 6 m/s on a circle of 8 m: 4.5 m/s² sideways, which could tilt the attitude by 25°.
  test::Sensors sensors;
  sensors.headings = true;
  const auto motion = test::departure(6.0, 0.125);
  test::EngineDriver driver(Settings{}, motion, sensors);
  driver.run(20.0);
  driver.fixes_on = false;
  const auto moment = driver.run(40.0);
  CHECK(std::acos(geometry::up_in_body(moment.pose.q_body_to_world).z()) <
        1.0 * geometry::radians_per_degree);
}

}  // namespace filters_test
