#include "ros2/relay/odometry_buffer.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace odometry_buffer_test {

using namespace sonopose;
using namespace sonopose::ros2;
using namespace sonopose::ros2::relay;

constexpr TimeNs ms = 1'000'000;

Transform driven(double way_m, double yaw_rad) {
  return {{way_m, 0, 0}, Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()))};
}

SCENARIO("the odometry is interpolated at the time of a pose") {
  GIVEN("odometry of 1 m at 100 ms, and 2 m and 0.2 rad at 150 ms") {
    OdometryBuffer track;
    track.add(100 * ms, driven(1, 0));
    track.add(150 * ms, driven(2, 0.2));
    THEN("between the two it is interpolated") {
      const auto at = track.at(125 * ms);
      REQUIRE(at);
      CHECK(at->translation_m.x() == Approx(1.5));
      CHECK(at->rotation.angularDistance(driven(0, 0.1).rotation) < 1e-12);
    }
    THEN("shortly after it is the latest, much later and before the first it is unknown") {
      REQUIRE(track.at(200 * ms));
      CHECK(track.at(200 * ms)->translation_m.x() == 2);
      CHECK_FALSE(track.at(150 * ms + OdometryBuffer::hold_ns + 1));
      CHECK_FALSE(track.at(99 * ms));
    }
    WHEN("a report arrives late") {
      track.add(120 * ms, driven(9, 0));
      THEN("it is ignored") {
        CHECK(track.at(125 * ms)->translation_m.x() == Approx(1.5));
      }
    }
    WHEN("the clock is set back by ten seconds") {
      track.add(-9'850 * ms, driven(7, 0));
      THEN("the previous reports are removed") {
        CHECK_FALSE(track.at(125 * ms));
        REQUIRE(track.at(-9'800 * ms));
        CHECK(track.at(-9'800 * ms)->translation_m.x() == 7);
      }
    }
    WHEN("a thousand more arrive") {
      for (int i = 1; i <= 1000; ++i) track.add((150 + i) * ms, driven(2 + i, 0));
      THEN("the latest ones are kept") {
        CHECK(track.at(1149 * ms)->translation_m.x() == Approx(1001));
        CHECK_FALSE(track.at(200 * ms));
      }
    }
  }
}

TEST_CASE("map → odom gives the base its fused pose") {
  const Transform base_in_map{{5, 6, 0}, Quaterniond(Eigen::AngleAxisd(2.0, Vector3d::UnitZ()))};
  const Transform base_in_odom{{1, -3, 0.1}, Quaterniond(Eigen::AngleAxisd(-0.5, Vector3d::UnitZ()))};
  const Transform again = odom_in_map(base_in_map, base_in_odom) * base_in_odom;
  CHECK((again.translation_m - base_in_map.translation_m).norm() < 1e-12);
  CHECK(again.rotation.angularDistance(base_in_map.rotation) < 1e-12);
}

TEST_CASE("Odometry of any time is kept or replaced, and looked up") {
  constexpr TimeNs least = std::numeric_limits<TimeNs>::min();
  constexpr TimeNs greatest = std::numeric_limits<TimeNs>::max();
  OdometryBuffer track;
  track.add(least, driven(1, 0));
  track.add(greatest, driven(3, 0));
  CHECK(track.at(greatest)->translation_m.x() == 3);
  CHECK(track.at(least)->translation_m.x() == 1);
  CHECK(track.at(0));
  track.add(least, driven(5, 0));  // the clock was set back
  CHECK(track.at(least)->translation_m.x() == 5);
  CHECK_FALSE(track.at(greatest));
}

}  // namespace odometry_buffer_test
