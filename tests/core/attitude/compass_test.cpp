/// The compass, and the conventions of its headings.

#include "attitude/ahrs_support.hpp"
#include <sonopose/attitude/compass.hpp>

#include <catch2/catch.hpp>

namespace compass_test {

using namespace sonopose;
using namespace sonopose::testing;
using attitude::compass_heading;
using attitude::Convention;

double degrees_of(Convention convention, const attitude::Measurement<double>& m) {
  const auto heading_rad = compass_heading(convention, m.specific_force_body_mps2, m.magnetic_field_body_t);
  REQUIRE(heading_rad);
  return *heading_rad / degree;
}

TEST_CASE("level and looking north, east, south: each convention's own angle") {
  // The world is ENU: a yaw of 90° faces north.
  const auto looking_north = at_rest(geometry::rotation_about_z(90 * degree));
  CHECK(degrees_of(Convention::nwu, looking_north) == Approx(0.0).margin(1e-9));
  CHECK(degrees_of(Convention::enu, looking_north) == Approx(90.0));
  CHECK(degrees_of(Convention::ned, looking_north) == Approx(0.0).margin(1e-9));
  const auto looking_east = at_rest(Quaterniond::Identity());
  CHECK(degrees_of(Convention::nwu, looking_east) == Approx(-90.0));
  CHECK(degrees_of(Convention::enu, looking_east) == Approx(0.0).margin(1e-9));
  CHECK(degrees_of(Convention::ned, looking_east) == Approx(90.0));
}

TEST_CASE("tilt does not change the heading: it is the yaw of the orientation in the convention") {
  for (const Convention convention : {Convention::nwu, Convention::enu, Convention::ned}) {
    for (const double yaw_deg : {-170.0, -30.0, 0.0, 75.0, 140.0}) {
      for (const double pitch_deg : {-80.0, 0.0, 30.0}) {
        for (const double roll_deg : {-100.0, 0.0, 45.0, 180.0}) {
          const Quaterniond q = geometry::rotation_of(
              geometry::EulerAngles<double>{roll_deg * degree, pitch_deg * degree, yaw_deg * degree});
          const Eigen::Vector2d north(0.6, 0.8);
          INFO("yaw " << yaw_deg << " pitch " << pitch_deg << " roll " << roll_deg);
          const double expected_deg =
              geometry::yaw_of(attitude::orientation_in(convention, north, q)) / degree;
          CHECK(degrees_of(convention, at_rest(q, north)) == Approx(expected_deg));
          // The length of either vector is irrelevant.
          auto scaled = at_rest(q, north);
          scaled.specific_force_body_mps2 *= 1e-3;
          scaled.magnetic_field_body_t *= 1e6;
          CHECK(degrees_of(convention, scaled) == Approx(expected_deg));
        }
      }
    }
  }
}

TEST_CASE("without a heading the compass returns none") {
  const Vector3d up(0, 0, 9.8);
  const Vector3d field(2e-5, 0, -4e-5);
  const Vector3d none = Vector3d::Zero();
  CHECK_FALSE(compass_heading(Convention::nwu, none, field));
  CHECK_FALSE(compass_heading(Convention::nwu, up, none));
  CHECK_FALSE(compass_heading(Convention::nwu, up, Vector3d(0, 0, -5e-5)));
  CHECK_FALSE(compass_heading(Convention::nwu, Vector3d(9.8, 0, 0), field));  // body X is vertical
  CHECK(compass_heading(Convention::nwu, up, field));
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

}  // namespace compass_test
