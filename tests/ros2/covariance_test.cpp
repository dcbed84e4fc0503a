#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/covariance.hpp>

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace sonopose;
using namespace sonopose::ros2;

namespace {

FusedPose pose_of_a_turning_robot() {
  FusedPose pose;
  pose.position_world_m = {3, -1, 0.4};
  pose.q_body_to_world = Quaterniond(Eigen::AngleAxisd(1.1, Vector3d(0.1, -0.2, 0.97).normalized()));
  pose.velocity_world_mps = {1.5, -0.5, 0.1};
  pose.angular_velocity_body_radps = {0.1, -0.2, 0.8};
  pose.pose_covariance.set(0, 0, 0.02 * 0.02);
  pose.pose_covariance.set(1, 1, 0.03 * 0.03);
  pose.pose_covariance.set(2, 2, 0.05 * 0.05);
  pose.pose_covariance.set(5, 5, 0.03 * 0.03);
  pose.velocity_covariance = Covariance<3>::from_diagonal({0.05 * 0.05, 0.06 * 0.06, 0.08 * 0.08});
  return pose;
}

/// The spread of many poses that are wrong by chance, as much as their standard deviations say.
template <class Error>
Covariance6 spread_of(const FusedPose& pose, const Noise& noise, const Error& error_of) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto vector = [&](const Vector3d& std) {
    return Vector3d(normal(random) * std.x(), normal(random) * std.y(), normal(random) * std.z());
  };
  constexpr int count = 200'000;
  Covariance6 sum = Covariance6::Zero();
  for (int i = 0; i < count; ++i) {
    FusedPose wrong = pose;
    wrong.position_world_m += vector(position_std_m(pose));
    wrong.velocity_world_mps += vector(velocity_std_mps(pose));
    const double tilt_std_rad = noise.tilt_std_deg * geometry::radians_per_degree;
    const Vector3d turn = vector({tilt_std_rad, tilt_std_rad, yaw_std_rad(pose)});
    wrong.q_body_to_world = geometry::rotation_by(turn) * pose.q_body_to_world;
    wrong.angular_velocity_body_radps += vector(Vector3d::Constant(noise.gyro_std_radps));
    const Eigen::Matrix<double, 6, 1> error = error_of(wrong, turn);
    sum += error * error.transpose();
  }
  return sum / count;
}

void check_close(const Covariance6& computed, const Covariance6& seen) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      CAPTURE(row, column, computed(row, column), seen(row, column));
      // 200,000 draws tell a covariance to about half a percent of the two deviations' product.
      const double scale = std::sqrt(seen(row, row) * seen(column, column));
      CHECK(std::abs(computed(row, column) - seen(row, column)) < 0.02 * scale);
    }
  }
  CHECK((computed - computed.transpose()).norm() == 0);
  // Cholesky's decomposition needs a matrix that is positive definite.
  CHECK(Eigen::LLT<Eigen::Matrix<double, 6, 6>>(computed).info() == Eigen::Success);
}

}  // namespace

SCENARIO("a covariance is the spread of the errors that it speaks of") {
  GIVEN("a robot in motion, its IMU at the end of an arm and turned, and what its pose is sure of") {
    const FusedPose pose = pose_of_a_turning_robot();
    const Mount mount{{0.8, -0.3, 0.5}, Quaterniond(Eigen::AngleAxisd(0.6, Vector3d(1, 2, 2) / 3))};
    const Noise noise{.gyro_std_radps = 0.02, .tilt_std_deg = 1.2};
    const BaseState truth = base_state(pose, mount);
    WHEN("the base's pose is made from many that are wrong by as much") {
      const auto error = [&](const FusedPose& wrong, const Vector3d& turn) {
        Eigen::Matrix<double, 6, 1> both;
        both << base_state(wrong, mount).position_map_m - truth.position_map_m, turn;
        return both;
      };
      THEN("they spread as its covariance says") {
        check_close(pose_covariance(pose, mount, noise), spread_of(pose, noise, error));
      }
    }
    WHEN("the base's velocity is made from them") {
      const auto error = [&](const FusedPose& wrong, const Vector3d& /*turn*/) {
        const BaseState base = base_state(wrong, mount);
        Eigen::Matrix<double, 6, 1> both;
        both << base.velocity_base_mps - truth.velocity_base_mps,
            base.angular_velocity_base_radps - truth.angular_velocity_base_radps;
        return both;
      };
      THEN("they spread as its covariance says, in the base's own axes") {
        check_close(twist_covariance(pose, mount, noise), spread_of(pose, noise, error));
      }
    }
  }
}

TEST_CASE("No variance is zero, whatever a pose says of itself") {
  FusedPose sure;  // every standard deviation is 0
  CHECK(pose_covariance(sure, {}, {}).diagonal().minCoeff() > 0);
  CHECK(twist_covariance(sure, {}, {}).diagonal().minCoeff() > 0);
  CHECK(orientation_covariance(sure, {}).diagonal().minCoeff() > 0);
}

SCENARIO("a fix is worth what the fusion gave it") {
  const double std_m = 0.02;
  GIVEN("a fix of which nobody said anything") {
    THEN("its standard deviation is that of a good one") {
      CHECK(std::sqrt(fix_covariance(std_m, std::nullopt)(1, 1)) == Approx(std_m));
    }
  }
  GIVEN("one of a quarter's weight") {
    THEN("it is half as sure") {
      CHECK(std::sqrt(fix_covariance(std_m, 0.25)(2, 2)) == Approx(2 * std_m));
    }
  }
  GIVEN("one that was refused") {
    THEN("it is next to nothing, though not nothing: 100 times as unsure") {
      CHECK(std::sqrt(fix_covariance(std_m, 0.0)(0, 0)) == Approx(100 * std_m));
    }
  }
  GIVEN("a position alone") {
    const Covariance6 pose = without_orientation(fix_covariance(std_m, 1.0));
    THEN("its orientation may be any") {
      CHECK(pose.topLeftCorner(3, 3).isApprox(fix_covariance(std_m, 1.0)));
      CHECK(std::sqrt(pose(5, 5)) == Approx(1.8138).margin(1e-4));  // uniform over the circle: π/√3
    }
  }
}
