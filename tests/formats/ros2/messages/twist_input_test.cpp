/// Velocities from ROS 2.

#include <sonopose/ros2/messages/twist_input.hpp>

#include <catch2/catch.hpp>

#include <limits>

namespace twist_input_test {

using namespace sonopose;
using ros2::mount_at;
using ros2::twist_sample;

constexpr TimeNs received_ns = 5'000'000'000;
constexpr std::uint32_t all_rates =
    twist_angular_velocity_x | twist_angular_velocity_y | twist_angular_velocity_z;

/// Drives at 2 m/s and turns left by 0.5 rad/s.
ros2::Odometry odometry() {
  ros2::Odometry message{};
  message.header.stamp = {4, 900'000'000};
  message.twist.twist.linear.x = 2.0;
  message.twist.twist.angular.z = 0.5;
  return message;
}

SCENARIO("wheel odometry from ROS 2") {
  GIVEN("odometry without covariance, and an IMU at the base") {
    const auto twist = twist_sample(odometry(), 7, {}, received_ns);
    THEN("all axes are measured with unknown deviation, at the stamp") {
      REQUIRE(twist);
      CHECK(twist->velocity_body_mps == Vector3d(2, 0, 0));
      CHECK(twist->velocity_std_mps == Vector3d::Constant(-1));
      CHECK(twist->axes == (all_rates | twist_velocity_x | twist_velocity_y | twist_velocity_z));
      CHECK(twist->emission_time_ns == 4'900'000'000);
      CHECK(twist->received_time_ns == received_ns);
      CHECK(twist->address == 7);
    }
  }
  GIVEN("an IMU 0.3 m left of the base, turned left by 90°") {
    const auto twist = twist_sample(odometry(), 7, mount_at({0, 0.3, 0, 0, 0, 90}), received_ns);
    THEN("its velocity is that of its place, in its axes") {
      REQUIRE(twist);
      // 2 − 0.5 · 0.3 forward, which is to the right of the IMU.
      CHECK(twist->velocity_body_mps.isApprox(Vector3d(0, -1.85, 0), 1e-12));
    }
  }
  GIVEN("a covariance that says that only the forward speed is measured") {
    ros2::Odometry message = odometry();
    message.twist.covariance[0] = 0.01;
    message.twist.covariance[7] = 1e6;
    message.twist.covariance[14] = -1;
    THEN("the others are not") {
      const auto twist = twist_sample(message, 7, {}, received_ns);
      REQUIRE(twist);
      CHECK(twist->axes == (all_rates | twist_velocity_x));
      CHECK(twist->velocity_std_mps.x() == Approx(0.1));
    }
    THEN("the axis of a turned IMU is found") {
      const auto twist = twist_sample(message, 7, mount_at({0, 0, 0, 0, 0, -90}), received_ns);
      REQUIRE(twist);
      CHECK(twist->axes == (all_rates | twist_velocity_y));
      CHECK(twist->velocity_body_mps.y() == Approx(2.0));
      CHECK(twist->velocity_std_mps.y() == Approx(0.1));
    }
    THEN("an oblique mount cannot use it") {
      CHECK_FALSE(twist_sample(message, 7, mount_at({0, 0, 0, 0, 0, 30}), received_ns));
    }
  }
  GIVEN("messages that cannot be used") {
    ros2::Odometry message = odometry();
    WHEN("a value is not finite") {
      message.twist.twist.linear.x = std::numeric_limits<double>::quiet_NaN();
      THEN("it is empty") {
        CHECK_FALSE(twist_sample(message, 7, {}, received_ns));
      }
    }
    WHEN("no axis is measured") {
      for (const int i : {0, 7, 14}) message.twist.covariance[i] = -1;
      THEN("it is empty") {
        CHECK_FALSE(twist_sample(message, 7, {}, received_ns));
      }
    }
  }
  GIVEN("a TwistStamped without a stamp") {
    ros2::TwistStamped message{};
    message.twist.linear.x = -0.4;
    const auto twist = twist_sample(message, 9, {}, received_ns);
    THEN("it was measured when it was received") {
      REQUIRE(twist);
      CHECK(twist->emission_time_ns == received_ns);
      CHECK(twist->velocity_body_mps.x() == -0.4);
    }
  }
}

}  // namespace twist_input_test
