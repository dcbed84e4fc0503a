/// Rotations against elementary geometry.

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <vector>

namespace rotation_test {

using namespace sonopose;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;

double distance(const Quaterniond& a, const Quaterniond& b) {
  return a.angularDistance(b);
}

TEST_CASE("an angle wraps into half a turn either way") {
  CHECK(geometry::wrap_angle(0.0) == 0.0);
  CHECK(geometry::wrap_angle(3.0 * pi / 2.0) == Approx(-pi / 2.0));
  CHECK(geometry::wrap_angle(-3.0 * pi / 2.0) == Approx(pi / 2.0));
  CHECK(std::abs(geometry::wrap_angle(pi)) == Approx(pi));
  CHECK(geometry::wrap_angle(100.0 * 2.0 * pi + 0.25) == Approx(0.25));
}

TEST_CASE("the rotation vector turns by its length about itself") {
  SECTION("a quarter turn about Z takes X to Y") {
    const Quaterniond q = geometry::rotation_by({0.0, 0.0, pi / 2.0});
    CHECK((q * Vector3d::UnitX() - Vector3d::UnitY()).norm() < 1e-15);
  }
  SECTION("it agrees with the axis-angle form over all sizes, the series' seam included") {
    const Vector3d axis = Vector3d(0.3, -0.5, 0.8).normalized();
    for (const double angle : {1e-12, 1e-7, 1e-4, 1e-2, 0.1, 0.1999, 0.2, 0.2001, 0.5, 3.0}) {
      const Quaterniond expected(Eigen::AngleAxisd(angle, axis));
      const Quaterniond q = geometry::rotation_by(angle * axis);
      INFO("angle " << angle);
      CHECK((q.coeffs() - expected.coeffs()).norm() < 4e-16);
      CHECK(std::abs(q.norm() - 1.0) < 4e-16);
    }
  }
  SECTION("none is none") {
    CHECK(distance(geometry::rotation_by(Vector3d::Zero()), Quaterniond::Identity()) == 0.0);
  }
}

TEST_CASE("yaw is the direction of body X on the ground") {
  for (const double yaw : {-3.0, -1.0, 0.0, 0.7, 2.5}) {
    CHECK(geometry::yaw_of(geometry::rotation_about_z(yaw)) == Approx(yaw).margin(1e-15));
    const Quaterniond pitched = geometry::rotation_about_z(yaw) *
                                Quaterniond(Eigen::AngleAxisd(0.6, Vector3d::UnitY())) *
                                Quaterniond(Eigen::AngleAxisd(-0.4, Vector3d::UnitX()));
    CHECK(geometry::yaw_of(pitched) == Approx(yaw).margin(1e-15));
    const Vector3d x_world = pitched * Vector3d::UnitX();
    CHECK(std::atan2(x_world.y(), x_world.x()) == Approx(yaw).margin(1e-15));
  }
}

TEST_CASE("up in the body is world Z turned back") {
  const Quaterniond q = geometry::rotation_by({0.4, -1.1, 2.0});
  CHECK((geometry::up_in_body(q) - q.conjugate() * Vector3d::UnitZ()).norm() < 1e-15);
}

TEST_CASE("levelling puts a force at rest upright and keeps the yaw that was asked for") {
  const std::vector<Vector3d> forces{{0, 0, 9.81},      {3, -2, 8}, {9.7, 0.5, 0.1},
                                     {0.1, -9.7, -0.3}, {1, 2, -9}, {0, 0, -9.81}};
  for (const Vector3d& force : forces) {
    const Quaterniond q = geometry::level_with(force, 1.2);
    INFO("force " << force.transpose());
    CHECK((q * force.normalized() - Vector3d::UnitZ()).norm() < 1e-12);
    CHECK(geometry::yaw_of(q) == Approx(1.2));
  }
}

TEST_CASE("levelling gives a rotation for a force of any size") {
  for (const double size : {0.0, 1e-320, 1e-300, 1e-160, 1e160, 1e300}) {
    const Quaterniond q = geometry::level_with({0, size, 0}, 1.2);
    INFO("force " << size);
    CHECK(std::abs(q.norm() - 1) < 1e-12);
    if (size > 0) CHECK((q * Vector3d::UnitY() - Vector3d::UnitZ()).norm() < 1e-9);
  }
}

}  // namespace rotation_test
