/// History of the inertial path over the last second.

#include <sonopose/estimation/documented/history.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace history_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

InertialPoint point_at(double time_s) {
  return {start_ns + to_ns(time_s), Vector3d(2.0 * time_s, 0, -time_s), 0.5 * time_s};
}

TEST_CASE("the path is interpolated, and unknown before its beginning") {
  InertialHistory history;
  CHECK(history.empty());
  CHECK_FALSE(history.at(start_ns).has_value());
  for (int i = 0; i < 50; ++i) history.push(point_at(0.01 * i));
  const auto between = history.at(start_ns + to_ns(0.123));
  REQUIRE(between.has_value());
  CHECK((between->displacement_world_m - Vector3d(0.246, 0, -0.123)).norm() < 1e-9);
  CHECK(between->yaw_rad == Approx(0.0615));
  CHECK_FALSE(history.at(start_ns - 1).has_value());
  CHECK(history.at(start_ns).has_value());
}

TEST_CASE("after its end the path stays at its newest point") {
  InertialHistory history;
  history.push(point_at(0.0));
  history.push(point_at(0.01));
  CHECK(*history.at(start_ns + to_ns(5.0)) == point_at(0.01));
}

TEST_CASE("yaw is interpolated in the shorter direction") {
  InertialHistory history;
  history.push({start_ns, Vector3d::Zero(), 3.1});
  history.push({start_ns + to_ns(0.01), Vector3d::Zero(), -3.1});
  const auto middle = history.at(start_ns + to_ns(0.005));
  REQUIRE(middle.has_value());
  CHECK(std::abs(std::remainder(middle->yaw_rad - M_PI, 2.0 * M_PI)) < 1e-9);
}

TEST_CASE("at every IMU rate it spans more than a second") {
  for (const double rate_hz : {10.0, 100.0, 200.0, 399.0, 401.0, 500.0, 770.0, 1000.0, 8000.0}) {
    INFO("IMU at " << rate_hz << " Hz");
    InertialHistory history;
    const auto samples = static_cast<int>(3.0 * rate_hz);
    for (int i = 0; i <= samples; ++i) history.push(point_at(i / rate_hz));
    const auto old = history.at(start_ns + to_ns(2.0));
    REQUIRE(old.has_value());
    CHECK(old->displacement_world_m.x() == Approx(4.0).epsilon(1e-6));
    CHECK(history.newest() == point_at(samples / rate_hz));
  }
}

TEST_CASE("samples with the same stamp are one point of the path, the latest") {
  InertialHistory history;
  for (int burst = 0; burst < 40; ++burst) {
    for (int i = 0; i < 21; ++i) {
      InertialPoint point = point_at(0.06 * burst);
      point.yaw_rad = i;
      history.push(point);
    }
  }
  CHECK(history.newest().yaw_rad == 20.0);
  const auto old = history.at(start_ns + to_ns(0.03));
  REQUIRE(old.has_value());
  CHECK(old->displacement_world_m.x() == Approx(0.06));
}

TEST_CASE("a cleared history is empty") {
  InertialHistory history;
  history.push(point_at(0.0));
  history.push(point_at(0.01));
  history.clear();
  CHECK(history.empty());
  CHECK_FALSE(history.at(start_ns + to_ns(0.01)).has_value());
}

}  // namespace history_test
