#include "autopilot/external_odometry.hpp"

#include "autopilot/ardupilot.hpp"
#include "autopilot/px4.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace external_odometry_test {

using namespace sonopose;
using autopilot::external_odometry;

FusedPose with_variances(const std::array<double, 6>& pose_variances, const Vector3d& velocity_variances) {
  FusedPose pose;
  pose.position_world_m = {1, 2, 3};
  Eigen::Matrix<double, 6, 1> diagonal;
  for (int i = 0; i < 6; ++i) diagonal[i] = pose_variances.at(static_cast<std::size_t>(i));
  pose.pose_covariance = Covariance<6>::from_diagonal(diagonal);
  pose.velocity_covariance = Covariance<3>::from_diagonal(velocity_variances);
  return pose;
}

const std::array<double, 6> variances{0.04, 0.09, 0.16, 0.0025, 0.0036, 0.0049};
const Vector3d velocity_variances{0.25, 0.36, 0.49};
constexpr double half_pi = std::numbers::pi / 2;

SCENARIO("variances follow their axes") {
  GIVEN("a level body that faces the map's x, with a variance of its own per axis") {
    const FusedPose pose = with_variances(variances, velocity_variances);
    WHEN("north is the map's y") {
      const auto odometry = external_odometry(pose, {}, half_pi);
      THEN("those of north and east are exchanged, and the body's are about roll, pitch and yaw") {
        CHECK(odometry.pose_covariance.diagonal().head<3>().isApprox(Vector3d(0.09, 0.04, 0.16), 1e-9));
        CHECK(odometry.pose_covariance.diagonal().tail<3>().isApprox(Vector3d(0.0036, 0.0025, 0.0049), 1e-9));
        CHECK(odometry.velocity_covariance_frame.diagonal().isApprox(Vector3d(0.36, 0.25, 0.49), 1e-9));
        CHECK(odometry.orientation_variance_body_rad2.isApprox(Vector3d(0.0025, 0.0036, 0.0049), 1e-9));
      }
    }
    WHEN("north is unknown") {
      const auto odometry = external_odometry(pose, {}, {});
      THEN("the frame is the map, turned over about x") {
        CHECK_FALSE(odometry.is_ned);
        CHECK(odometry.position_frame_m.isApprox(Vector3d(1, -2, -3)));
        CHECK(odometry.pose_covariance.diagonal().head<3>().isApprox(Vector3d(0.04, 0.09, 0.16), 1e-9));
      }
    }
    WHEN("the IMU is half a metre in front of the base") {
      const ros2::Mount mount{.imu_in_base_m = {0.5, 0, 0}};
      const auto odometry = external_odometry(pose, mount, {});
      THEN("the base is behind it, and the uncertain yaw adds to its variance across") {
        CHECK(odometry.position_frame_m.isApprox(Vector3d(0.5, -2, -3)));
        CHECK(odometry.pose_covariance(1, 1) == Approx(0.09 + 0.25 * 0.0049));
      }
    }
    WHEN("it also turns left about its base, so that the IMU moves along y at 1 m/s") {
      FusedPose turning = pose;
      turning.angular_velocity_body_radps = {0, 0, 2};
      const ros2::Mount mount{.imu_in_base_m = {0.5, 0, 0}};
      THEN("uncertain yaw adds to the variance of the velocity along x, and roll to that along z") {
        const Vector3d added = external_odometry(turning, mount, {}).velocity_covariance_frame.diagonal() -
                               external_odometry(pose, mount, {}).velocity_covariance_frame.diagonal();
        CHECK(added.isApprox(Vector3d(0.0049, 0, 0.0025), 1e-6));
      }
      THEN("the velocity is unknown if the yaw is") {
        turning.status = status_heading_unknown;
        CHECK(external_odometry(turning, mount, {}).velocity_frame_mps.array().isNaN().all());
      }
    }
  }
  GIVEN("a pose that claims to be exact") {
    const auto odometry = external_odometry(with_variances({}, Vector3d::Zero()), {}, {});
    THEN("no variance is below the floor") {
      CHECK(odometry.pose_covariance.diagonal().head<3>().minCoeff() >= 1e-4 * 0.999);
      CHECK(odometry.orientation_variance_body_rad2.minCoeff() >= 1e-4 * 0.999);
      CHECK(odometry.velocity_covariance_frame.diagonal().minCoeff() >= 4e-4 * 0.999);
      CHECK(odometry.velocity_covariance_body.diagonal().minCoeff() >= 4e-4 * 0.999);
    }
  }
}

SCENARIO("what is unknown is NaN, never zero") {
  FusedPose pose = with_variances(variances, velocity_variances);
  const auto none_is_a_number = [](const auto& values) {
    return std::none_of(std::begin(values), std::end(values), [](float value) { return value == value; });
  };
  GIVEN("a pose whose yaw is not known") {
    pose.status = status_heading_unknown;
    const auto odometry = external_odometry(pose, {}, half_pi);
    const auto message = vehicle_odometry(odometry, 1, 1, 0, 50);
    THEN("there is no quaternion, no velocity in body axes, and no variance of them") {
      CHECK_FALSE(odometry.q_body_to_frame);
      CHECK(none_is_a_number(message.q));
      CHECK(none_is_a_number(message.orientation_variance));
      CHECK(odometry.velocity_body_mps.array().isNaN().all());
    }
    THEN("position and velocity of the frame are as before") {
      CHECK(message.position[0] == Approx(2));
      CHECK(message.position_variance[0] == Approx(0.09));
      CHECK(message.velocity_variance[2] == Approx(0.49));
    }
  }
  GIVEN("a pose whose velocity has no variance") {
    pose.velocity_covariance = {};
    const auto message = vehicle_odometry(external_odometry(pose, {}, {}), 1, 1, 0, 50);
    THEN("it has no velocity") {
      CHECK(none_is_a_number(message.velocity));
      CHECK(none_is_a_number(message.velocity_variance));
      CHECK(message.q[0] == Approx(1));
    }
  }
}

SCENARIO("ArduPilot gets no NaN") {
  using autopilot::NotSent;
  FusedPose pose = with_variances(variances, velocity_variances);
  const auto reason = [&](bool with_velocity) {
    return ardupilot_not_sent(external_odometry(pose, {}, half_pi), with_velocity);
  };
  GIVEN("a pose with everything") {
    THEN("it is sent") {
      CHECK(reason(true) == NotSent::none);
    }
  }
  GIVEN("one without yaw") {
    pose.status = status_heading_unknown;
    THEN("it is not sent") {
      CHECK(reason(false) == NotSent::yaw_unknown);
    }
  }
  GIVEN("one without velocity") {
    pose.velocity_covariance = {};
    THEN("it is sent only by messages without one") {
      CHECK(reason(true) == NotSent::no_velocity);
      CHECK(reason(false) == NotSent::none);
    }
  }
}

}  // namespace external_odometry_test
