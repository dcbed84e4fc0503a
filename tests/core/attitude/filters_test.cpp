/// Properties of every attitude filter.

#include <sonopose/attitude/any_filter.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

namespace filters_test {

using namespace sonopose;
using namespace sonopose::attitude;

template <class F>
using Settings = typename F::Settings;

/// Gains with which every correcting filter converges within a minute.
template <class F>
Settings<F> converging_settings() {
  return {};
}
template <>
MahonySettings converging_settings<Mahony>() {
  MahonySettings settings;
  settings.kp = 1.0;
  settings.heading_kp = 1.0;
  return settings;
}
template <>
MahonySettings converging_settings<BasicMahony<float>>() {
  return converging_settings<Mahony>();
}
template <>
attitude::Settings converging_settings<AnyFilter>() {
  attitude::Settings settings;
  settings.selection.filter = FilterKind::mahony;
  settings.mahony = converging_settings<Mahony>();
  return settings;
}

template <class F>
constexpr bool corrects = !std::is_same_v<F, BasicGyro<typename F::Scalar>>;

/// Tolerance for the accumulated rounding of the filter's scalar type.
template <class F>
constexpr double tolerance_rad = std::is_same_v<typename F::Scalar, float> ? 1e-3 : 1e-6;

template <class F>
using Measured = Measurement<typename F::Scalar>;

/// A body at rest with the attitude `q_body_to_world`, its magnetometer in a field that dips by 60°.
template <class F>
Measured<F> at_rest(const Quaterniond& q_body_to_world, double dt_s, double north_rad) {
  using Scalar = typename F::Scalar;
  const Eigen::Vector2d north(std::cos(north_rad), std::sin(north_rad));
  const Vector3d field_world_t(25e-6 * north.x(), 25e-6 * north.y(), -43.3e-6);
  Measured<F> measurement;
  measurement.dt_s = Scalar(dt_s);
  measurement.specific_force_body_mps2 =
      (q_body_to_world.conjugate() * Vector3d(0, 0, 9.80665)).template cast<Scalar>();
  measurement.magnetic_field_body_t = (q_body_to_world.conjugate() * field_world_t).template cast<Scalar>();
  measurement.north_world = north.template cast<Scalar>();
  return measurement;
}

template <class F>
double angle_between(const F& filter, const Quaterniond& q_body_to_world) {
  return filter.orientation().template cast<double>().angularDistance(q_body_to_world);
}

template <class F>
void reset(F& filter, const Quaterniond& q_body_to_world) {
  filter.reset(q_body_to_world.template cast<typename F::Scalar>());
}

const Quaterniond some_attitude = geometry::rotation_by({0.4, -0.9, 1.7});

#define EVERY_FILTER                                                                                     \
  Mahony, Complementary, Ahrs, Gyro, Adaptive, AnyFilter, BasicMahony<float>, BasicComplementary<float>, \
      BasicAhrs<float>, BasicGyro<float>, BasicAdaptive<float>

TEMPLATE_TEST_CASE("it is a filter", "", EVERY_FILTER) {
  STATIC_REQUIRE(Filter<TestType>);
}

TEMPLATE_TEST_CASE("with the gyroscope alone a constant rate is integrated exactly, at any step", "",
                   EVERY_FILTER) {
  const Vector3d rate_radps(1.2, -0.7, 0.5);
  TestType filter;
  reset(filter, some_attitude);
  Measured<TestType> measurement;
  measurement.angular_velocity_body_radps = rate_radps.cast<typename TestType::Scalar>();
  double time_s = 0;
  for (int i = 0; i < 1000; ++i) {
    const double dt_s = i % 3 == 0 ? 0.002 : i % 3 == 1 ? 0.011 : 0.1;
    measurement.dt_s = static_cast<typename TestType::Scalar>(dt_s);
    filter.update(converging_settings<TestType>(), measurement);
    time_s += dt_s;
  }
  const Quaterniond expected = some_attitude * geometry::rotation_by(rate_radps * time_s);
  CHECK(angle_between(filter, expected) < tolerance_rad<TestType>);
  CHECK(filter.orientation().norm() == Approx(1.0).margin(1e-6));
}

TEMPLATE_TEST_CASE("a gyroscope's offset that is given is taken off", "", EVERY_FILTER) {
  using Vector = geometry::Vector3<typename TestType::Scalar>;
  TestType filter;
  reset(filter, some_attitude);
  const Vector offset(typename TestType::Scalar(0.02), typename TestType::Scalar(-0.01),
                      typename TestType::Scalar(0.03));
  filter.set_gyro_bias(offset);
  CHECK((filter.gyro_bias_body_radps() - offset).norm() < 1e-9);
  Measured<TestType> measurement;
  measurement.dt_s = typename TestType::Scalar(0.01);
  measurement.angular_velocity_body_radps = offset;
  for (int i = 0; i < 1000; ++i) filter.update(converging_settings<TestType>(), measurement);
  CHECK(angle_between(filter, some_attitude) < tolerance_rad<TestType>);
  WHEN("it is re-initialised") {
    reset(filter, some_attitude);
    THEN("the offset is forgotten") {
      CHECK(filter.gyro_bias_body_radps().norm() == 0.0);
    }
  }
}

TEMPLATE_TEST_CASE("gravity corrects the tilt, from any attitude and at any", "", EVERY_FILTER) {
  for (const Quaterniond& truth :
       {Quaterniond::Identity(), some_attitude, geometry::rotation_by({3.1, 0.0, 0.0}),
        geometry::rotation_by({0.0, std::acos(0.0), 0.0})}) {
    TestType filter;
    // A large tilt, and nearly upside down.
    for (const double off_rad : {1.0, 3.0}) {
      reset(filter, geometry::rotation_by({off_rad, 0.0, 0.0}) * truth);
      Measured<TestType> measurement = at_rest<TestType>(truth, 0.01, 0.0);
      measurement.magnetic_field_body_t.setZero();
      for (int i = 0; i < 10'000; ++i) filter.update(converging_settings<TestType>(), measurement);
      const Vector3d up_body = geometry::up_in_body(filter.orientation()).template cast<double>();
      const double tilt_rad = std::acos(std::min(1.0, up_body.dot(geometry::up_in_body(truth))));
      INFO("off by " << off_rad << " rad at first");
      if (corrects<TestType>) CHECK(tilt_rad < 0.01);
      if (!corrects<TestType>) CHECK(tilt_rad == Approx(off_rad).epsilon(0.01));
    }
  }
}

TEMPLATE_TEST_CASE("the magnetometer turns heading to north, wherever north lies in the world", "",
                   EVERY_FILTER) {
  if (!corrects<TestType>) return;
  const double quarter = std::acos(0.0);
  for (const double north_rad : {0.0, quarter, -2.0}) {
    TestType filter;
    reset(filter, geometry::rotation_about_z(1.5) * some_attitude);
    // More than a minute: some filters first verify that the field is the Earth's.
    for (int i = 0; i < 12'000; ++i) {
      filter.update(converging_settings<TestType>(), at_rest<TestType>(some_attitude, 0.01, north_rad));
    }
    INFO("north at " << north_rad << " rad");
    CHECK(angle_between(filter, some_attitude) < 0.01);
  }
}

TEMPLATE_TEST_CASE("what is known of the acceleration is not taken for gravity", "", EVERY_FILTER) {
  using Vector = geometry::Vector3<typename TestType::Scalar>;
  TestType filter;
  reset(filter, some_attitude);
  Measured<TestType> measurement = at_rest<TestType>(some_attitude, 0.01, 0.0);
  measurement.magnetic_field_body_t.setZero();
  measurement.acceleration_world_mps2 = Vector(3, -1, 2);
  measurement.specific_force_body_mps2 +=
      filter.orientation().conjugate() * measurement.acceleration_world_mps2;
  for (int i = 0; i < 3000; ++i) filter.update(converging_settings<TestType>(), measurement);
  CHECK(angle_between(filter, some_attitude) < 10 * tolerance_rad<TestType>);
}

TEMPLATE_TEST_CASE("turn_in_world rotates the estimate, and a step of zero changes nothing", "",
                   EVERY_FILTER) {
  using Vector = geometry::Vector3<typename TestType::Scalar>;
  TestType filter;
  reset(filter, some_attitude);
  for (int i = 0; i < 500; ++i)
    filter.update(converging_settings<TestType>(), at_rest<TestType>(some_attitude, 0.01, 0.0));
  const Quaterniond before = filter.orientation().template cast<double>();
  const Vector turn(typename TestType::Scalar(0.1), typename TestType::Scalar(-0.2),
                    typename TestType::Scalar(0.3));
  filter.turn_in_world(turn);
  const Quaterniond turned = geometry::rotation_by(Vector3d(0.1, -0.2, 0.3)) * before;
  CHECK(angle_between(filter, turned) < tolerance_rad<TestType>);
  Measured<TestType> measurement;
  measurement.angular_velocity_body_radps = Vector(1, 2, 3);
  filter.update(converging_settings<TestType>(), measurement);
  CHECK(angle_between(filter, turned) < tolerance_rad<TestType>);
}

TEMPLATE_TEST_CASE("a filter is a value, and its fields are all of it", "", EVERY_FILTER) {
  TestType filter;
  reset(filter, some_attitude);
  const auto step = [](TestType& one, int i) {
    Measured<TestType> measurement = at_rest<TestType>(some_attitude, 0.01, 0.3);
    measurement.angular_velocity_body_radps.x() = typename TestType::Scalar(0.5 * std::sin(0.1 * i));
    one.update(converging_settings<TestType>(), measurement);
  };
  for (int i = 0; i < 777; ++i) step(filter, i);
  GIVEN("a copy") {
    TestType copy = filter;
    CHECK(copy == filter);
    WHEN("one goes on") {
      step(filter, 777);
      THEN("they differ until the other does too") {
        CHECK_FALSE(copy == filter);
        step(copy, 777);
        CHECK(copy == filter);
      }
    }
  }
  GIVEN("another one that is given each field") {
    TestType other;
    if constexpr (std::is_same_v<TestType, AnyFilter>) other.select(filter.kind());
    TestType forgotten = filter;
    reset(forgotten, Quaterniond::Identity());
    CHECK(forgotten == other);
    std::vector<const void*> fields;
    filter.for_each_field([&fields](const char*, const auto& field) { fields.push_back(&field); });
    std::size_t next = 0;
    other.for_each_field([&](const char*, auto& field) {
      field = *static_cast<const std::remove_reference_t<decltype(field)>*>(fields[next++]);
    });
    THEN("it is the same") {
      CHECK(next > 1);
      CHECK(other == filter);
      step(other, 777);
      step(filter, 777);
      CHECK(other == filter);
    }
  }
}

}  // namespace filters_test
