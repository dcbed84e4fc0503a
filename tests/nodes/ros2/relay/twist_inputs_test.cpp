/// Options of velocities from ROS 2.

#include "ros2/relay/twist_inputs.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace twist_inputs_test {

using namespace sonopose;
using Catch::Matchers::Contains;
using ros2::relay::TwistInput;

SCENARIO("options of velocities") {
  GIVEN("topics with addresses") {
    THEN("they are parsed") {
      const auto odometry = TwistInput::parse_odometry("/odom=7");
      CHECK(odometry.type == TwistInput::Type::odometry);
      CHECK(odometry.topic == "/odom");
      CHECK(odometry.address == 7);
      CHECK(TwistInput::parse_twist("/wheel=7").type == TwistInput::Type::twist_with_covariance);
      const auto stamped = TwistInput::parse_twist("/wheel:TwistStamped=8");
      CHECK(stamped.type == TwistInput::Type::twist);
      CHECK(stamped.topic == "/wheel");
      CHECK(stamped.address == 8);
    }
  }
  GIVEN("mistakes") {
    THEN("they are named") {
      CHECK_THROWS_WITH(TwistInput::parse_odometry("/odom"),
                        Contains("--odom-in /odom: expected TOPIC=ADDRESS"));
      CHECK_THROWS_WITH(TwistInput::parse_twist("/wheel:Twist=7"), Contains("'Twist' is not"));
      CHECK_THROWS_WITH(ros2::relay::check(std::vector{TwistInput::parse_odometry("/odom=7"),
                                                       TwistInput::parse_twist("/wheel=7")}),
                        Contains("only one source of velocities, not /odom and /wheel"));
    }
  }
}

}  // namespace twist_inputs_test
