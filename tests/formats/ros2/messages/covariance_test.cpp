#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/covariance.hpp>

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

namespace covariance_test {

using namespace sonopose;
using namespace sonopose::ros2;

/// A positive definite covariance with correlations between all components.
template <int N>
Eigen::Matrix<double, N, N> correlated(const Eigen::Matrix<double, N, 1>& std_devs) {
  Eigen::Matrix<double, N, N> correlation = Eigen::Matrix<double, N, N>::Identity();
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column < row; ++column) {
      correlation(row, column) = correlation(column, row) = (row + column) % 2 == 0 ? 0.15 : -0.1;
    }
  }
  return std_devs.asDiagonal() * correlation * std_devs.asDiagonal();
}

FusedPose pose_of_a_turning_robot() {
  FusedPose pose;
  pose.position_world_m = {3, -1, 0.4};
  pose.q_body_to_world = Quaterniond(Eigen::AngleAxisd(1.1, Vector3d(0.1, -0.2, 0.97).normalized()));
  pose.velocity_world_mps = {1.5, -0.5, 0.1};
  pose.angular_velocity_body_radps = {0.1, -0.2, 0.8};
  Eigen::Matrix<double, 6, 1> pose_std;
  pose_std << 0.02, 0.03, 0.05, 0.02, 0.025, 0.03;
  pose.pose_covariance = Covariance<6>::from_matrix(correlated<6>(pose_std));
  pose.velocity_covariance = Covariance<3>::from_matrix(correlated<3>(Vector3d(0.05, 0.06, 0.08)));
  return pose;
}

/// Sample covariances of the base's pose and twist for random errors drawn from the pose's covariances.
struct Spread {
  Covariance6 pose = Covariance6::Zero();
  Covariance6 twist = Covariance6::Zero();
};
Spread spread_of(const FusedPose& pose, const Mount& mount, const Noise& noise) {
  const BaseState truth = base_state(pose, mount);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto draw = [&]<int N>(const Eigen::Matrix<double, N, N>& root) {
    Eigen::Matrix<double, N, 1> independent;
    for (int i = 0; i < N; ++i) independent[i] = normal(random);
    return Eigen::Matrix<double, N, 1>(root * independent);
  };
  const Eigen::Matrix<double, 6, 6> pose_root = pose.pose_covariance.matrix().llt().matrixL();
  const Eigen::Matrix3d velocity_root = pose.velocity_covariance.matrix().llt().matrixL();
  const Eigen::Matrix3d gyro_root = noise.gyro_std_radps * Eigen::Matrix3d::Identity();
  constexpr int count = 50'000;
  Spread spread;
  for (int i = 0; i < count; ++i) {
    FusedPose wrong = pose;
    const Eigen::Matrix<double, 6, 1> pose_error = draw(pose_root);
    const Vector3d turn = pose_error.tail<3>();
    wrong.position_world_m += pose_error.head<3>();
    wrong.velocity_world_mps += draw(velocity_root);
    wrong.q_body_to_world = geometry::rotation_by(turn) * pose.q_body_to_world;
    wrong.angular_velocity_body_radps += draw(gyro_root);
    const BaseState base = base_state(wrong, mount);
    Eigen::Matrix<double, 6, 1> error;
    error << base.position_map_m - truth.position_map_m, turn;
    spread.pose += error * error.transpose() / count;
    error << base.velocity_base_mps - truth.velocity_base_mps,
        base.angular_velocity_base_radps - truth.angular_velocity_base_radps;
    spread.twist += error * error.transpose() / count;
  }
  return spread;
}

void check_close(const Covariance6& computed, const Covariance6& sampled) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      CAPTURE(row, column, computed(row, column), sampled(row, column));
      // The standard error of 50,000 draws is about 0.5 % of the product of both standard deviations.
      const double scale = std::sqrt(sampled(row, row) * sampled(column, column));
      CHECK(std::abs(computed(row, column) - sampled(row, column)) < 0.02 * scale);
    }
  }
  CHECK((computed - computed.transpose()).norm() == 0);
  // Succeeds only for a positive definite matrix.
  CHECK(Eigen::LLT<Eigen::Matrix<double, 6, 6>>(computed).info() == Eigen::Success);
}

SCENARIO("the covariance is the spread of the errors") {
  GIVEN("a moving robot, an IMU with lever arm and rotation, and a pose with correlated errors") {
    const FusedPose pose = pose_of_a_turning_robot();
    const Mount mount{{0.8, -0.3, 0.5}, Quaterniond(Eigen::AngleAxisd(0.6, Vector3d(1, 2, 2) / 3))};
    const Noise noise{.gyro_std_radps = 0.02, .tilt_std_deg = 1.2};
    WHEN("poses and velocities of the base are computed from many poses with random errors") {
      const Spread spread = spread_of(pose, mount, noise);
      THEN("their spread is the covariance, that of the velocities in the axes of the base") {
        check_close(pose_covariance(pose, mount, noise), spread.pose);
        check_close(twist_covariance(pose, mount, noise), spread.twist);
      }
    }
  }
}

TEST_CASE("No variance is zero, for any pose") {
  FusedPose sure;
  sure.pose_covariance = Covariance<6>::from_diagonal(Eigen::Matrix<double, 6, 1>::Zero());
  sure.velocity_covariance = Covariance<3>::from_diagonal(Vector3d::Zero());
  for (const FusedPose& pose : {sure, FusedPose{}}) {  // all variances zero, and all unknown
    CHECK(pose_covariance(pose, {}, {}).diagonal().minCoeff() > 0);
    CHECK(twist_covariance(pose, {}, {}).diagonal().minCoeff() > 0);
    CHECK(orientation_covariance(pose, {}).diagonal().minCoeff() > 0);
  }
}

SCENARIO("the covariance of a fix depends on its weight") {
  const double std_m = 0.02;
  GIVEN("a fix without a report") {
    THEN("it has full weight") {
      CHECK(std::sqrt(fix_covariance(std_m, std::nullopt)(1, 1)) == Approx(std_m));
    }
  }
  GIVEN("a fix with weight 1/4") {
    THEN("its standard deviation is twice as large") {
      CHECK(std::sqrt(fix_covariance(std_m, 0.25)(2, 2)) == Approx(2 * std_m));
    }
  }
  GIVEN("a rejected fix") {
    THEN("its standard deviation is 100 times as large") {
      CHECK(std::sqrt(fix_covariance(std_m, 0.0)(0, 0)) == Approx(100 * std_m));
    }
  }
  GIVEN("a position without orientation") {
    const Covariance6 pose = without_orientation(fix_covariance(std_m, 1.0));
    THEN("its orientation is uniform") {
      CHECK(pose.topLeftCorner(3, 3).isApprox(fix_covariance(std_m, 1.0)));
      CHECK(std::sqrt(pose(5, 5)) == Approx(1.8138).margin(1e-4));  // uniform over the circle: π/√3
    }
  }
}

}  // namespace covariance_test
