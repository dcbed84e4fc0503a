/// The filter chosen at run time, and samples with time stamps.

#include <sonopose/attitude/any_filter.hpp>

#include <catch2/catch.hpp>

#include <limits>

namespace any_filter_test {

using namespace sonopose;
using namespace sonopose::attitude;

ImuSample sample_at(double time_s, const Vector3d& rate_radps) {
  ImuSample imu;
  imu.sensor_time_ns = 1'700'000'000'000'000'000 + to_ns(time_s);
  imu.angular_velocity_body_radps = rate_radps;
  imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
  return imu;
}

TEST_CASE("every kind can be selected, and a new one continues from the previous orientation") {
  attitude::Settings settings;
  AnyFilter filter;
  filter.reset(geometry::rotation_by({0.0, 0.0, 1.0}));
  filter.set_gyro_bias({0.0, 0.0, 0.02});
  Measurement<double> measurement;
  measurement.dt_s = 0.01;
  measurement.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
  measurement.angular_velocity_body_radps.z() = 0.02;
  constexpr auto names = choices_of(FilterKind{});
  for (std::size_t kind = 0; kind < names.size(); ++kind) {
    settings.selection.filter = static_cast<FilterKind>(kind);
    for (int i = 0; i < 50; ++i) filter.update(settings, measurement);
    INFO(names[kind]);
    CHECK(filter.kind() == settings.selection.filter);
    CHECK(geometry::yaw_of(filter.orientation()) == Approx(1.0).margin(1e-3));
    CHECK(filter.gyro_bias_body_radps().z() == Approx(0.02).margin(1e-3));
  }
}

TEST_CASE("the chosen filter gives the same bits as the one named at compile time") {
  attitude::Settings settings;
  settings.selection.filter = FilterKind::mahony;
  Tracker<AnyFilter> chosen(settings, {});
  Tracker<Mahony> named(settings.mahony, {});
  for (int i = 0; i < 500; ++i) {
    const ImuSample imu = sample_at(0.01 * i + (i % 7) * 0.0003, {0.3, 0.1 * i / 500.0, -0.2});
    REQUIRE(chosen.on(imu));
    REQUIRE(named.on(imu));
  }
  CHECK(chosen.filter().orientation().coeffs() == named.filter().orientation().coeffs());
}

TEST_CASE("a tracker takes the step from the stamps, and leaves out what is no measurement") {
  Tracker<Gyro> tracker({}, {});
  const Vector3d rate_radps(0, 0, 0.5);
  CHECK(tracker.on(sample_at(0.0, rate_radps)));
  CHECK(tracker.on(sample_at(0.1, rate_radps)));
  CHECK(tracker.on(sample_at(0.4, rate_radps)));
  CHECK(geometry::yaw_of(tracker.filter().orientation()) == Approx(0.2));
  CHECK_FALSE(tracker.on(sample_at(0.3, rate_radps)));
  CHECK_FALSE(tracker.on(sample_at(0.5, {0, 0, std::numeric_limits<double>::quiet_NaN()})));
  CHECK(tracker.on(sample_at(0.4, rate_radps)));
  CHECK(geometry::yaw_of(tracker.filter().orientation()) == Approx(0.2));
}

TEST_CASE("a tracker goes on from a clock that was set back") {
  Tracker<Gyro> tracker({}, {});
  const Vector3d rate_radps(0, 0, 0.5);
  for (int i = 0; i <= 100; ++i) CHECK(tracker.on(sample_at(10.0 + 0.01 * i, rate_radps)));
  int rejected = 0;
  for (int i = 0; i < 100; ++i) rejected += tracker.on(sample_at(0.01 * i, rate_radps)) ? 0 : 1;
  CHECK(rejected == max_backward_samples - 1);
  // One second before the step; after it from the sample that was believed.
  CHECK(geometry::yaw_of(tracker.filter().orientation()) ==
        Approx(0.5 + 0.5 * 0.01 * (100 - max_backward_samples)));
}

TEST_CASE("one stamp far ahead costs a tracker its own sample only") {
  Tracker<Gyro> tracker({}, {});
  const Vector3d rate_radps(0, 0, 0.5);
  for (int i = 0; i <= 100; ++i) {
    const bool is_corrupt = i == 50;
    CHECK(tracker.on(sample_at(is_corrupt ? 1000.0 : 0.01 * i, rate_radps)) != is_corrupt);
  }
  CHECK(geometry::yaw_of(tracker.filter().orientation()) == Approx(0.5));
}

TEST_CASE("a tracker starts level, and with a magnetometer pointing as it says") {
  const Quaterniond truth = geometry::rotation_of(geometry::EulerAngles<double>{0.3, -0.2, 2.5});
  ImuSample imu = sample_at(0.0, Vector3d::Zero());
  imu.specific_force_body_mps2 = truth.conjugate() * imu.specific_force_body_mps2;
  imu.magnetic_field_body_t = truth.conjugate() * Vector3d(-20e-6, 0, -40e-6);  // north is the world's −X
  Tracker<Gyro> with_field({}, {.use_magnetometer = true, .north_deg = 180});
  with_field.on(imu);
  CHECK(with_field.filter().orientation().angularDistance(truth) < 1e-9);
  Tracker<Gyro> without({}, {});
  without.on(imu);
  CHECK(geometry::up_in_body(without.filter().orientation()).dot(geometry::up_in_body(truth)) == Approx(1.0));
  CHECK(geometry::yaw_of(without.filter().orientation()) == Approx(0.0).margin(1e-9));
}

}  // namespace any_filter_test
