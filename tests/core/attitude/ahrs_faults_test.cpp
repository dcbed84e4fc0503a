/// Known faults of such filters that this one avoids: external headings on a pitched body, a saturated
/// gyroscope, zero gain.

#include "attitude/ahrs_support.hpp"

#include <catch2/catch.hpp>

namespace ahrs_faults_test {

using namespace sonopose;
using namespace sonopose::testing;
using attitude::Convention;

/// Level and turning left; the gyroscope saturates at its range.
attitude::Measurement<double> turning(double rate_radps, double range_radps) {
  auto m = without_field(at_rest(Quaterniond::Identity()));
  m.angular_velocity_body_radps = {0, 0, std::min(rate_radps, range_radps)};
  return m;
}

AhrsSettings with_range(double range_dps) {
  AhrsSettings settings;
  settings.gyro_range_dps = range_dps;
  return settings;
}

TEST_CASE("the filter converges to an external heading at any pitch, in every convention") {
  const double heading_rad = 60 * degree;
  for (const Convention convention : {Convention::nwu, Convention::enu, Convention::ned}) {
    for (const Eigen::Vector2d& north : {Eigen::Vector2d(0, 1), Eigen::Vector2d(0.6, -0.8)}) {
      for (const double pitch_deg : {0.0, 30.0, -70.0}) {
        for (const double roll_deg : {0.0, 25.0, 170.0}) {
          INFO("pitch " << pitch_deg << " roll " << roll_deg);
          const Quaterniond in_convention = geometry::rotation_of(
              geometry::EulerAngles<double>{roll_deg * degree, pitch_deg * degree, heading_rad});
          const Quaterniond truth =
              attitude::world_to_convention(convention, north).conjugate() * in_convention;
          Ahrs filter;
          const auto m = without_field(at_rest(truth, north));
          for (int i = 0; i < 3000; ++i) filter.update_external_heading({}, m, heading_rad, convention);
          const auto angles =
              geometry::euler_angles_of(attitude::orientation_in(convention, north, filter.orientation()));
          CHECK(angles.yaw_rad / degree == Approx(60.0).margin(0.01));
          CHECK(distance_rad(filter, truth) < 1e-4);
        }
      }
    }
  }
}

TEST_CASE("a heading from outside in the world is the yaw there") {
  const Quaterniond truth = geometry::rotation_about_z(-2.0) * geometry::rotation_by({0, -0.5, 0});
  Ahrs filter;
  for (int i = 0; i < 3000; ++i) filter.update_external_heading({}, without_field(at_rest(truth)), -2.0);
  CHECK(geometry::yaw_of(filter.orientation()) == Approx(-2.0).margin(1e-4));
  CHECK(distance_rad(filter, truth) < 1e-4);
}

TEST_CASE("an external heading has no effect while body X is vertical") {
  const Quaterniond truth = geometry::rotation_by({0, -std::numbers::pi / 2, 0});
  Ahrs filter = settled_at(truth);
  const Quaterniond before = filter.orientation();
  for (int i = 0; i < 100; ++i) filter.update_external_heading({}, without_field(at_rest(truth)), 1.0);
  CHECK(distance_rad(filter, before) < 1e-6);
}

TEST_CASE("without a magnetometer, a rate beyond the range loses only the clipped part of the heading") {
  const double range_radps = 500 * degree;
  const AhrsSettings settings = with_range(500.0);
  Ahrs filter = settled_at(Quaterniond::Identity(), settings);
  double yaw_rad = 0.0;
  double hidden_rad = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double rate_radps = i >= 300 && i < 305 ? 700 * degree : 80 * degree;
    filter.update(settings, turning(rate_radps, range_radps));
    yaw_rad += rate_radps * step_s;
    hidden_rad += (rate_radps - std::min(rate_radps, range_radps)) * step_s;
    CHECK(filter.flags(settings).over_range == (i >= 300 && i < 604));
    CHECK(filter.flags(settings).initialising == (i >= 300 && i < 604));
  }
  const double error_rad = geometry::wrap_angle(geometry::yaw_of(filter.orientation()) - yaw_rad);
  CHECK(hidden_rad == Approx(10 * degree));
  CHECK(std::abs(error_rad) <= hidden_rad + rounding_rad);
  CHECK(tilt_error_rad(filter, Quaterniond::Identity()) < rounding_rad);
}

TEST_CASE("initialising corrects the tilt error that a rate beyond the range caused") {
  // The gyroscope missed a turn of 60° about a horizontal axis.
  const Quaterniond truth = geometry::rotation_by({60 * degree, 0, 0});
  const AhrsSettings settings = with_range(500.0);
  Ahrs filter = settled_at(Quaterniond::Identity(), settings);
  auto m = without_field(at_rest(truth));
  m.angular_velocity_body_radps = {499 * degree, 0, 0};
  filter.update(settings, m);
  m.angular_velocity_body_radps.setZero();
  run(filter, settings, m, 3.0);
  CHECK(tilt_error_rad(filter, truth) < 1 * degree);
}

TEST_CASE("a range of 0 is never exceeded, and initialising from the start is not over-range") {
  Ahrs filter;
  filter.update({}, turning(5000 * degree, 1e9));
  CHECK(filter.flags({}).initialising);
  CHECK_FALSE(filter.flags({}).over_range);
}

TEST_CASE("a gain of 0 is the gyroscope alone from the first update") {
  for (const RejectionForm form : {RejectionForm::recovery, RejectionForm::seed}) {
    AhrsSettings settings;
    settings.gain = 0.0;
    settings.rejection = form;
    settings.gyro_offset = false;
    const Quaterniond start = geometry::rotation_by({0.3, 0.2, -1.0});
    Ahrs filter;
    filter.reset(start);
    CHECK_FALSE(filter.flags(settings).initialising);
    auto m = at_rest(Quaterniond::Identity());
    m.angular_velocity_body_radps = {0.1, -0.2, 0.3};
    filter.update(settings, m);
    CHECK_FALSE(filter.flags(settings).initialising);
    CHECK(distance_rad(filter, start * geometry::rotation_by({0.001, -0.002, 0.003})) < 1e-12);
    run(filter, settings, m, 20.0);
    const Vector3d turned = 20.01 * m.angular_velocity_body_radps;
    CHECK(distance_rad(filter, start * geometry::rotation_by(turned)) < rounding_rad);
  }
}

}  // namespace ahrs_faults_test
