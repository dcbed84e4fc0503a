#include <sonopose/ros2/messages/frames.hpp>

#include <catch2/catch.hpp>

#include <numbers>
#include <stdexcept>

namespace frames_test {

using namespace sonopose;
using namespace sonopose::ros2;

constexpr double pi = std::numbers::pi;

Quaterniond about_z(double angle_rad) {
  return Quaterniond(Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ()));
}

TEST_CASE("Each {address} in a pattern is replaced by the beacon's address") {
  CHECK(for_beacon("base_link", 7) == "base_link");
  CHECK(for_beacon("hedge_{address}/base_link", 7) == "hedge_7/base_link");
  CHECK(for_beacon("{address}_{address}", 131) == "131_131");
  CHECK_FALSE(has_frames_per_beacon({}, false));
  CHECK_FALSE(has_frames_per_beacon({.base = "hedge_{address}/base_link"}, false));
  FrameNames apart{.base = "hedge_{address}/base_link", .imu = "hedge_{address}/imu_link"};
  CHECK(has_frames_per_beacon(apart, false));
  CHECK_FALSE(has_frames_per_beacon(apart, true));  // both would publish the transform of `odom`
  apart.odom = "hedge_{address}/odom";
  CHECK(has_frames_per_beacon(apart, true));
}

TEST_CASE("Invalid frames are rejected by name") {
  CHECK_NOTHROW(check(FrameNames{}));
  CHECK_THROWS_WITH(check({.map = ""}), "the map frame '' needs a name");
  CHECK_THROWS_WITH(check({.base = "/base"}), "the base frame '/base' must not begin with a slash");
  CHECK_THROWS_WITH(check({.base = "body", .imu = "body"}),
                    "the imu frame 'body' has the same name as the base frame");
  try {
    check({.imu = "/imu"});
    FAIL("was not refused");
  } catch (const FrameError& error) {
    CHECK(error.frame() == "imu");
  }
}

TEST_CASE("Frames that coincide for a single beacon are rejected") {
  CHECK_THROWS_WITH(check({.base = "b7", .imu = "b{address}"}),
                    "the imu frame 'b7' of beacon 7 has the same name as its base frame");
  CHECK_THROWS_WITH(check({.map = "m{address}", .odom = "m65534"}), Catch::Contains("beacon 65534"));
  CHECK_THROWS_WITH(check({.base = "{address}{address}", .imu = "1{address}1"}),
                    Catch::Contains("beacon 11 "));
  CHECK_NOTHROW(check({.base = "b65535", .imu = "b{address}"}));  // not a valid beacon address
  CHECK_NOTHROW(check({.base = "hedge_{address}/base_link", .imu = "hedge_{address}/imu_link"}));
}

TEST_CASE("A mount is given in metres and degrees") {
  const Mount mount = mount_at({0.1, 0.2, 0.3, 0, 90, 0});
  CHECK(mount.imu_in_base_m == Vector3d(0.1, 0.2, 0.3));
  // Pitched nose down by 90°: the IMU's X points down in the base.
  CHECK((mount.q_imu_to_base * Vector3d::UnitX() + Vector3d::UnitZ()).norm() < 1e-12);
  CHECK_THROWS_WITH(mount_at({0, 0, 0, std::nan(""), 0, 0}), "roll is nan: it must be from -360 to 360 deg");
  CHECK_THROWS_WITH(mount_at({0, 0, -1000.5, 0, 0, 0}), "z is -1000.5: it must be from -1000 to 1000 m");
  CHECK_THROWS_AS(mount_at({0, 0, 0, 0, 0, 361}), std::invalid_argument);
  CHECK_NOTHROW(mount_at({1000, -1000, 0, 360, -360, 0}));
}

SCENARIO("base and IMU are one rigid body") {
  GIVEN("an IMU half a metre ahead of the base's origin, rotated by 90 degrees to the left") {
    const Mount mount{{0.5, 0, 0}, about_z(pi / 2)};
    WHEN("the robot stands at (3, 4), facing along X of the map") {
      FusedPose pose;
      pose.position_world_m = {3.5, 4, 0};
      pose.q_body_to_world = about_z(pi / 2);  // X of the IMU points to the left of the robot
      const BaseState base = base_state(pose, mount);
      THEN("the base has this position and no rotation") {
        CHECK((base.position_map_m - Vector3d(3, 4, 0)).norm() < 1e-12);
        CHECK(base.q_base_to_map.angularDistance(Quaterniond::Identity()) < 1e-12);
      }
    }
    WHEN("the robot rotates in place, 2 rad/s to the left") {
      FusedPose pose;
      pose.position_world_m = {0.5, 0, 0};
      pose.q_body_to_world = about_z(pi / 2);
      pose.velocity_world_mps = {0, 1, 0};  // ω × r
      pose.angular_velocity_body_radps = {0, 0, 2};
      const BaseState base = base_state(pose, mount);
      THEN("the base's origin has no velocity and rotates") {
        CHECK(base.velocity_base_mps.norm() < 1e-12);
        CHECK((base.angular_velocity_base_radps - Vector3d(0, 0, 2)).norm() < 1e-12);
      }
    }
    WHEN("the robot faces north and drives ahead at 1 m/s") {
      FusedPose pose;
      pose.position_world_m = {0, 0.5, 0};
      pose.q_body_to_world = about_z(pi);
      pose.velocity_world_mps = {0, 1, 0};
      const BaseState base = base_state(pose, mount);
      THEN("its velocity is along X of the base") {
        CHECK((base.velocity_base_mps - Vector3d(1, 0, 0)).norm() < 1e-12);
        CHECK(base.position_map_m.norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("A transform and its inverse give the identity") {
  const Transform there{{1, -2, 3}, Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 2) / 3))};
  const Transform back = there * inverse_of(there);
  CHECK(back.translation_m.norm() < 1e-12);
  CHECK(back.rotation.angularDistance(Quaterniond::Identity()) < 1e-12);
  // A point of the child frame is rotated, then translated.
  const Transform quarter{{1, 0, 0}, about_z(pi / 2)};
  CHECK(((quarter * Transform{{2, 0, 0}, Quaterniond::Identity()}).translation_m - Vector3d(1, 2, 0)).norm() <
        1e-12);
}

}  // namespace frames_test
