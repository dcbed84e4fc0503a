#include <sonopose/calibration/model/axes.hpp>
#include <sonopose/calibration/model/calibration.hpp>

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace axes_test {

using namespace sonopose;
using namespace sonopose::calibration;

AxesSettings named(std::string_view name) {
  const auto names = choices_of(Axes{});
  AxesSettings settings;
  for (std::size_t place = 0; place < names.size(); ++place) {
    if (names[place] == name) settings.axes = static_cast<Axes>(place);
  }
  return settings;
}

TEST_CASE("all 24 mountings are proper rotations by right angles, each another one") {
  std::vector<Matrix3d> seen;
  for (const std::string_view name : choices_of(Axes{})) {
    CAPTURE(std::string(name));
    const Matrix3d rotation = sensor_to_body(named(name));
    CHECK(rotation * rotation.transpose() == Matrix3d::Identity());
    CHECK(rotation.determinant() == 1.0);
    CHECK(rotation.cwiseAbs().sum() == 3.0);
    for (const Matrix3d& other : seen) CHECK(rotation != other);
    seen.push_back(rotation);
  }
  CHECK(seen.size() == 24);
}

TEST_CASE("a name gives the sensor's axes along body X, Y and Z") {
  CHECK(sensor_to_body(AxesSettings{}) == Matrix3d::Identity());
  CHECK(sensor_to_body(named("+y-x+z")) * Vector3d(1.0, 2.0, 3.0) == Vector3d(2.0, -1.0, 3.0));
  CHECK(sensor_to_body(named("-z+x-y")) * Vector3d(1.0, 2.0, 3.0) == Vector3d(-3.0, 1.0, -2.0));
}

TEST_CASE("GIVEN a sensor that lies on its back THEN the body's Z axis still reads gravity upwards") {
  Settings settings;
  settings.axes = named("-x+y-z");  // turned by 180° about Y
  ImuSample raw;
  raw.specific_force_body_mps2 = {0.1, 0.2, -9.8};
  raw.angular_velocity_body_radps = {1.0, 2.0, 3.0};
  raw.magnetic_field_body_t = Vector3d(20e-6, 5e-6, -40e-6);
  const ImuSample body = Calibration(settings).corrected(raw);
  CHECK(body.specific_force_body_mps2 == Vector3d(-0.1, 0.2, 9.8));
  CHECK(body.angular_velocity_body_radps == Vector3d(-1.0, 2.0, -3.0));
  CHECK(body.magnetic_field_body_t.value() == Vector3d(-20e-6, 5e-6, 40e-6));
}

TEST_CASE("offsets and factors are in the sensor's axes, whatever the mounting") {
  Settings settings;
  settings.axes = named("+y-x+z");
  settings.accelerometer.offset_y_mps2 = 0.5;
  settings.magnetometer.hard_iron_y_ut = 10.0;
  ImuSample raw;
  raw.specific_force_body_mps2 = {1.0, 2.0, 3.0};
  raw.magnetic_field_body_t = Vector3d(30e-6, 20e-6, 0.0);
  const ImuSample body = Calibration(settings).corrected(raw);
  CHECK(body.specific_force_body_mps2 == Vector3d(1.5, -1.0, 3.0));
  CHECK((body.magnetic_field_body_t.value() - Vector3d(10e-6, -30e-6, 0.0)).norm() < 1e-18);
}

}  // namespace axes_test
