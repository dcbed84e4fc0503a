#include "ros2/inputs/aiding_input.hpp"

#include "ros2/inputs/wheels_file.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace aiding_input_test {

using namespace sonopose;
using Catch::Matchers::Contains;
using ros2::AidingInput;
using Kind = AidingInput::Kind;

SCENARIO("a joint that is left and right is refused") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "wheels.toml",
                   "left_joints = [\"a\", \"b\"]\nright_joints = [\"b\"]\nradius_m = 0.1\ntrack_m = 0.5\n");
  CHECK_THROWS_WITH(ros2::read_wheels(folder / "wheels.toml"), Contains("the joint \"b\" is left and right"));
}

SCENARIO("options of velocities") {
  GIVEN("topics with addresses") {
    THEN("they are parsed") {
      const auto odometry = AidingInput::parse(Kind::odometry, "/odom=7");
      CHECK(odometry.type == AidingInput::Type::odometry);
      CHECK(odometry.topic == "/odom");
      CHECK(odometry.address == 7);
      CHECK(AidingInput::parse(Kind::twist, "/wheel=7").type == AidingInput::Type::twist_with_covariance);
      const auto stamped = AidingInput::parse(Kind::twist, "/wheel:TwistStamped=8");
      CHECK(stamped.type == AidingInput::Type::twist);
      CHECK(stamped.topic == "/wheel");
      CHECK(stamped.address == 8);
    }
  }
  GIVEN("mistakes") {
    THEN("they are named") {
      CHECK_THROWS_WITH(AidingInput::parse(Kind::odometry, "/odom"),
                        Contains("--odom-in /odom: expected TOPIC=ADDRESS"));
      CHECK_THROWS_WITH(AidingInput::parse(Kind::odometry, "/odom=70000"),
                        Contains("--odom-in /odom=70000: '70000' is not an address from 0 to 65534"));
      CHECK_THROWS_WITH(AidingInput::parse(Kind::twist, "/wheel:Twist=7"), Contains("'Twist' is not"));
      CHECK_THROWS_WITH(
          ros2::check(std::vector{AidingInput::parse(Kind::odometry, "/odom=7"),
                                  AidingInput::parse(Kind::twist, "/wheel=7")}),
          Contains(
              "--odom-in /odom=7 and --twist-in /wheel=7: beacon 7 can have only one source of velocities"));
      CHECK_THROWS_WITH(
          AidingInput::parse(Kind::heading, "/yaw:Float32=7"),
          Contains(
              "--heading-in /yaw:Float32=7: 'Float32' is not Imu or PoseWithCovarianceStamped or Float64"));
      CHECK_NOTHROW(ros2::check(std::vector{AidingInput::parse(Kind::set_pose, "/initialpose=7"),
                                            AidingInput::parse(Kind::set_pose, "/set_pose=7"),
                                            AidingInput::parse(Kind::set_pose, "/set_pose:SetPose=7"),
                                            AidingInput::parse(Kind::set_pose, "/set_pose=8"),
                                            AidingInput::parse(Kind::heading, "/compass=7"),
                                            AidingInput::parse(Kind::pose, "/vision=7")}));
      for (const char* const other : {"/set_pose:SetPose=7", "/set_pose:SetPose=8"}) {
        CHECK_THROWS_WITH(ros2::check(std::vector{AidingInput::parse(Kind::set_pose, "/set_pose:SetPose=7"),
                                                  AidingInput::parse(Kind::set_pose, other)}),
                          Contains("one service can set the pose of one beacon only"));
      }
    }
  }
}

}  // namespace aiding_input_test
