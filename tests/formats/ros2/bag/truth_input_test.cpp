/// True poses of a recording of ROS 2.

#include "ros2/bag/truth_input.hpp"

#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

namespace truth_input_test {

using namespace sonopose;
using namespace sonopose::ros2;
using Catch::Contains;

constexpr TimeNs at_ns = 1'700'000'000'000'000'000;

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

SCENARIO("a truth says of which frame it is, and when it was measured") {
  const FrameNames names;
  const std::string map = "/map";
  const std::string odom = "odom";
  const std::string marker = "marker";
  GIVEN("an IMU 1 m ahead of the base, and a marker 1 m to the left of the base, turned by 90°") {
    const Quaterniond quarter_left(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()));
    const Mount mount{.imu_in_base_m = {1, 0, 0}, .q_imu_to_base = Quaterniond::Identity()};
    bool is_connected = true;
    const FindFrame find = [&](const auto& /*in*/, const auto& frame) {
      const bool is_known = is_connected && frame == marker;
      return is_known ? std::optional(Transform{{0, 1, 0}, quarter_left}) : std::nullopt;
    };
    const InputFrames frames = input_frames(
        names, [&](BeaconAddress) { return std::optional(mount); }, find);
    bag::TruthInput truth(frames);
    Odometry odometry{};
    odometry.header = header_of(at_ns, map);
    odometry.child_frame_id = borrow_string(marker);
    odometry.pose.pose.orientation = {0, 0, 0, 1};
    WHEN("the marker stands at the origin and looks along x") {
      const auto pose = truth.on(odometry, 7, at_ns);
      REQUIRE(pose);
      THEN("the IMU is where it is seen from the marker, and nothing is assumed") {
        CHECK(pose->time_ns == at_ns);
        // In the axes of the base the IMU is (1, -1) m from the marker, whose x is the base's y.
        CHECK(pose->position_world_m.isApprox(Vector3d(-1, -1, 0)));
        CHECK(pose->q_body_to_world.angularDistance(quarter_left.conjugate()) < 1e-7);
        CHECK(joined(truth.assumptions("map")).empty());
      }
    }
    WHEN("nothing connects the marker, and the pose has another frame than the fixes and no stamp") {
      is_connected = false;
      odometry.header = header_of(0, odom);
      const auto pose = truth.on(odometry, 7, at_ns + 5);
      REQUIRE(pose);
      THEN("it counts as the base in the frame of the fixes at its reception, and each is said") {
        CHECK(pose->time_ns == at_ns + 5);
        CHECK(pose->position_world_m.isApprox(Vector3d(1, 0, 0)));
        const std::string said = joined(truth.assumptions("map"));
        CHECK_THAT(said, Contains("has 1 message without a stamp") &&
                             Contains("is in frame 'odom', the fixes in 'map': they count as one frame") &&
                             Contains("is of 'marker', which /tf_static does not connect with the base"));
      }
    }
  }
}

}  // namespace truth_input_test
