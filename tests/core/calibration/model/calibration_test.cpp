#include <sonopose/calibration/model/calibration.hpp>

#include <catch2/catch.hpp>

#include <bit>
#include <cstdint>
#include <limits>

namespace calibration_test {

using namespace sonopose;
using namespace sonopose::calibration;

void check_same_bits(const Vector3d& a, const Vector3d& b) {
  for (int i = 0; i < 3; ++i) {
    CHECK(std::bit_cast<std::uint64_t>(a[i]) == std::bit_cast<std::uint64_t>(b[i]));
  }
}

ImuSample some_sample() {
  ImuSample sample;
  sample.address = 9;
  sample.sequence = 4711;
  sample.sensor_time_ns = 123'456'789;
  sample.bridge_time_ns = 123'556'789;
  sample.angular_velocity_body_radps = {0.1, -0.0, -0.3};
  sample.specific_force_body_mps2 = {1.0 / 3.0, 0.0, 9.7};
  sample.magnetic_field_body_t = Vector3d(21e-6, -0.0, -43e-6);
  return sample;
}

TEST_CASE("a calibration that nobody has set returns the very same bits") {
  ImuSample raw = some_sample();
  raw.specific_force_body_mps2.y() = std::numeric_limits<double>::infinity();
  for (const Calibration& calibration : {Calibration(), Calibration(Settings{})}) {
    const ImuSample same = calibration.corrected(raw);
    CHECK(same == raw);
    check_same_bits(same.angular_velocity_body_radps, raw.angular_velocity_body_radps);
    check_same_bits(same.specific_force_body_mps2, raw.specific_force_body_mps2);
    check_same_bits(same.magnetic_field_body_t.value(), raw.magnetic_field_body_t.value());
  }
}

TEST_CASE("values that are not measurements do not change, and a field that was not measured stays empty") {
  Settings settings;
  settings.gyroscope.offset_x_radps = 0.05;
  settings.magnetometer.hard_iron_x_ut = 5.0;
  ImuSample raw = some_sample();
  raw.magnetic_field_body_t.reset();
  ImuSample corrected = Calibration(settings).corrected(raw);
  CHECK_FALSE(corrected.magnetic_field_body_t.has_value());
  CHECK(corrected.angular_velocity_body_radps.x() == Approx(0.05));
  corrected.angular_velocity_body_radps = raw.angular_velocity_body_radps;
  CHECK(corrected == raw);
}

TEST_CASE("inertial: the offset is taken off, then comes the sensitivity, then the misalignment") {
  // By hand: (3, 5, 7) − (1, 1, 1) = (2, 4, 6); times (2, 0.5, 1) = (4, 2, 6);
  // x = 4 + 0.1·2 + 0.2·6, y = 0.3·4 + 2 + 0.4·6, z = −0.1·4 − 0.2·2 + 6.
  const Vector3d expected{5.4, 5.6, 5.2};
  const auto fill = [](InertialTerms& terms) {
    terms.sensitivity_x = 2.0;
    terms.sensitivity_y = 0.5;
    terms.misalignment_xy = 0.1;
    terms.misalignment_xz = 0.2;
    terms.misalignment_yx = 0.3;
    terms.misalignment_yz = 0.4;
    terms.misalignment_zx = -0.1;
    terms.misalignment_zy = -0.2;
  };
  Settings settings;
  ImuSample raw;
  SECTION("gyroscope") {
    fill(settings.gyroscope);
    settings.gyroscope.offset_x_radps = settings.gyroscope.offset_y_radps = 1.0;
    settings.gyroscope.offset_z_radps = 1.0;
    raw.angular_velocity_body_radps = {3.0, 5.0, 7.0};
    const ImuSample corrected = Calibration(settings).corrected(raw);
    CHECK((corrected.angular_velocity_body_radps - expected).norm() < 1e-14);
    CHECK(corrected.specific_force_body_mps2 == raw.specific_force_body_mps2);
  }
  SECTION("accelerometer") {
    fill(settings.accelerometer);
    settings.accelerometer.offset_x_mps2 = settings.accelerometer.offset_y_mps2 = 1.0;
    settings.accelerometer.offset_z_mps2 = 1.0;
    raw.specific_force_body_mps2 = {3.0, 5.0, 7.0};
    const ImuSample corrected = Calibration(settings).corrected(raw);
    CHECK((corrected.specific_force_body_mps2 - expected).norm() < 1e-14);
    CHECK(corrected.angular_velocity_body_radps == raw.angular_velocity_body_radps);
  }
}

TEST_CASE("magnetometer: the hard iron is taken off after the soft-iron matrix") {
  // By hand: S·(10, 20, 30) = (2·10 + 0.1·20 + 0.2·30, 0.1·10 + 20 + 0.3·30, 0.2·10 + 0.3·20 + 0.5·30) µT.
  Settings settings;
  settings.magnetometer.soft_iron_xx = 2.0;
  settings.magnetometer.soft_iron_xy = 0.1;
  settings.magnetometer.soft_iron_xz = 0.2;
  settings.magnetometer.soft_iron_yz = 0.3;
  settings.magnetometer.soft_iron_zz = 0.5;
  settings.magnetometer.hard_iron_x_ut = 1.0;
  settings.magnetometer.hard_iron_y_ut = 2.0;
  settings.magnetometer.hard_iron_z_ut = 3.0;
  ImuSample raw;
  raw.magnetic_field_body_t = Vector3d(10e-6, 20e-6, 30e-6);
  const ImuSample corrected = Calibration(settings).corrected(raw);
  CHECK((corrected.magnetic_field_body_t.value() - Vector3d(27e-6, 28e-6, 20e-6)).norm() < 1e-18);
}

}  // namespace calibration_test
