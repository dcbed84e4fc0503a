/// Outputs of the AHRS: orientation and accelerations in each convention, at simple attitudes.

#include "attitude/ahrs_support.hpp"
#include <sonopose/attitude/ahrs_outputs.hpp>

#include <catch2/catch.hpp>

namespace ahrs_outputs_test {

using namespace sonopose;
using namespace sonopose::testing;
using attitude::Convention;

const Eigen::Vector2d north_is_y(0, 1);
const Eigen::Vector2d north_is_x(1, 0);
constexpr double g = standard_gravity_mps2;

/// Roll, pitch and yaw in degrees.
Vector3d angles_deg(const Quaterniond& q) {
  const auto angles = geometry::euler_angles_of(q);
  return Vector3d(angles.roll_rad, angles.pitch_rad, angles.yaw_rad) / degree;
}

TEST_CASE("north, east and up of the world stand where each convention has them") {
  const Vector3d north(0, 1, 0);
  const Vector3d east(1, 0, 0);
  using attitude::vector_in;
  CHECK(vector_in(Convention::nwu, north_is_y, north).isApprox(Vector3d(1, 0, 0), 1e-12));
  CHECK(vector_in(Convention::nwu, north_is_y, east).isApprox(Vector3d(0, -1, 0), 1e-12));
  CHECK(vector_in(Convention::nwu, north_is_y, up_world).isApprox(Vector3d(0, 0, 1), 1e-12));
  CHECK(vector_in(Convention::enu, north_is_y, north).isApprox(Vector3d(0, 1, 0), 1e-12));
  CHECK(vector_in(Convention::enu, north_is_y, east).isApprox(Vector3d(1, 0, 0), 1e-12));
  CHECK(vector_in(Convention::enu, north_is_y, up_world).isApprox(Vector3d(0, 0, 1), 1e-12));
  CHECK(vector_in(Convention::ned, north_is_y, north).isApprox(Vector3d(1, 0, 0), 1e-12));
  CHECK(vector_in(Convention::ned, north_is_y, east).isApprox(Vector3d(0, 1, 0), 1e-12));
  CHECK(vector_in(Convention::ned, north_is_y, up_world).isApprox(Vector3d(0, 0, -1), 1e-12));
  // A world whose X points north is already NWU.
  CHECK(vector_in(Convention::nwu, north_is_x, north).isApprox(north, 1e-12));
}

TEST_CASE("an orientation is the same body in every convention") {
  const Quaterniond q = geometry::rotation_about_z(0.7) * geometry::rotation_by({0.3, -0.5, 0.2});
  const Vector3d in_body(0.2, -0.6, 0.9);
  for (const Convention convention : {Convention::nwu, Convention::enu, Convention::ned}) {
    const Quaterniond converted = attitude::orientation_in(convention, north_is_y, q);
    const Vector3d expected = attitude::vector_in(convention, north_is_y, Vector3d(q * in_body));
    CHECK((converted * in_body).isApprox(expected, 1e-12));
    CHECK((converted.toRotationMatrix() * in_body).isApprox(expected, 1e-12));
  }
}

TEST_CASE("angles of known attitudes, as settled on from the sensors") {
  using attitude::orientation_in;
  GIVEN("a body that lies level, Z up, and looks north") {
    const Ahrs filter = settled_at(geometry::rotation_about_z(90 * degree));
    const Quaterniond& q = filter.orientation();
    THEN("its angles are those of each convention") {
      CHECK(angles_deg(orientation_in(Convention::nwu, north_is_y, q)).isMuchSmallerThan(1.0, 1e-3));
      CHECK(angles_deg(orientation_in(Convention::enu, north_is_y, q)).isApprox(Vector3d(0, 0, 90), 1e-5));
      const Vector3d ned = angles_deg(orientation_in(Convention::ned, north_is_y, q));
      CHECK(std::abs(ned.x()) == Approx(180.0));  // a level NED body has Z down
      CHECK(std::abs(ned.z()) < 1e-3);
    }
  }
  GIVEN("an aircraft in NED: Z down, climbing by 20°, heading 60° to the east of north") {
    const Quaterniond converted =
        geometry::rotation_of(geometry::EulerAngles<double>{0.0, 20 * degree, 60 * degree});
    const Quaterniond truth =
        attitude::world_to_convention(Convention::ned, north_is_y).conjugate() * converted;
    const auto m = at_rest(truth);
    // The nose is up, so the specific force points forwards along X and against Z, which points down.
    THEN("its angles are those that were flown") {
      CHECK(m.specific_force_body_mps2.isApprox(
          Vector3d(g * std::sin(20 * degree), 0, -g * std::cos(20 * degree)), 1e-12));
      Ahrs filter;
      run(filter, {}, m, 30.0);
      const Quaterniond settled = orientation_in(Convention::ned, north_is_y, filter.orientation());
      CHECK((angles_deg(settled) - Vector3d(0, 20, 60)).norm() < 0.01);
    }
  }
}

TEST_CASE("at rest there is no acceleration but gravity, whatever the attitude") {
  for (const Vector3d& rotation : {Vector3d(0, 0, 0), Vector3d(1, 0.5, -2), Vector3d(3, 0, 0.3)}) {
    const Quaterniond q = geometry::rotation_by(rotation);
    const Vector3d force = at_rest(q).specific_force_body_mps2;
    CHECK(attitude::linear_acceleration_body_mps2(q, force).norm() < 1e-12);
    CHECK(attitude::earth_acceleration_world_mps2(q, force).norm() < 1e-12);
  }
  CHECK(at_rest(Quaterniond::Identity()).specific_force_body_mps2.z() == 9.80665);
}

TEST_CASE("an acceleration to the north is one along body X where the nose points north") {
  const Quaterniond looking_north_rolled =
      geometry::rotation_about_z(90 * degree) * geometry::rotation_by({40 * degree, 0, 0});
  const Vector3d acceleration_world(0, 2.0, 0);
  const Vector3d force = looking_north_rolled.conjugate() * (acceleration_world + g * up_world);
  CHECK(
      attitude::linear_acceleration_body_mps2(looking_north_rolled, force).isApprox(Vector3d(2, 0, 0), 1e-9));
  const Vector3d earth = attitude::earth_acceleration_world_mps2(looking_north_rolled, force);
  CHECK(earth.isApprox(acceleration_world, 1e-9));
  CHECK(attitude::vector_in(Convention::nwu, north_is_y, earth).isApprox(Vector3d(2, 0, 0), 1e-9));
  CHECK(attitude::vector_in(Convention::enu, north_is_y, earth).isApprox(Vector3d(0, 2, 0), 1e-9));
}

TEST_CASE("a yaw converts from a convention to the world and back") {
  for (const Convention convention : {Convention::nwu, Convention::enu, Convention::ned}) {
    for (const double yaw_rad : {-3.0, -1.0, 0.0, 0.5, 2.0}) {
      const Eigen::Vector2d north(-0.28, 0.96);
      const double world_rad = attitude::yaw_in_world(convention, north, yaw_rad);
      const Quaterniond q = geometry::rotation_about_z(world_rad) * geometry::rotation_by({0, 0.4, 0});
      CHECK(geometry::yaw_of(attitude::orientation_in(convention, north, q)) ==
            Approx(yaw_rad).margin(1e-12));
    }
  }
}

}  // namespace ahrs_outputs_test
