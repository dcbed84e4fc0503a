/// The choice of magnetic fields that define north.

#include <sonopose/attitude/adaptive.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace magnetic_test {

using namespace sonopose;
using namespace sonopose::attitude;

const Vector3d earth_t(0, 20e-6, -40e-6);
constexpr double turning_radps = 1.0;

struct Rig {
  MagneticSettings settings;
  MagneticState<double> state;

  double feed(double duration_s, const Vector3d& field_world_t, double rate_radps) {
    double weight = 0;
    for (int i = 0; i < std::lround(duration_s * 100.0); ++i) {
      weight = magnetic::update(settings, state, field_world_t, rate_radps, 0.01);
    }
    return weight;
  }
};

Rig that_knows_earth() {
  Rig rig;
  rig.feed(10.0, earth_t, turning_radps);
  return rig;
}

TEST_CASE("a field that stays the same while the body turns becomes the reference") {
  Rig rig;
  CHECK(rig.feed(30.0, earth_t, 0.0) < 1.0);  // at rest a magnet on the body would look the same
  CHECK(rig.state.disturbed);
  CHECK(rig.feed(rig.settings.first_field_s + 0.1, earth_t, turning_radps) == 1.0);
  CHECK_FALSE(rig.state.disturbed);
  CHECK(rig.state.reference.level_t == Approx(20e-6));
  CHECK(rig.state.reference.up_t == Approx(-40e-6));
}

TEST_CASE("a field of another norm or another dip is rejected, one turned about the vertical is not") {
  const double ten_deg = 10.0 * geometry::radians_per_degree;
  const auto dipped = [](double by_rad) { return geometry::rotation_by(Vector3d(by_rad, 0, 0)) * earth_t; };
  struct Case {
    const char* what;
    Vector3d field_t;
    bool accepted;
  };
  for (const auto& [what, field_t, accepted] :
       {Case{"8 % stronger", 1.08 * earth_t, true}, Case{"15 % stronger", 1.15 * earth_t, false},
        Case{"15 % weaker", 0.85 * earth_t, false}, Case{"dips by 8° more", dipped(0.8 * ten_deg), true},
        Case{"dips by 15° more", dipped(1.5 * ten_deg), false},
        Case{"another heading", geometry::rotation_about_z(2.0) * earth_t, true}}) {
    INFO(what);
    Rig rig = that_knows_earth();
    CHECK((rig.feed(1.0, field_t, turning_radps) == 1.0) == accepted);
  }
}

TEST_CASE("after a disturbance the field is believed when it has been right for a while") {
  Rig rig = that_knows_earth();
  CHECK(rig.feed(5.0, 2.0 * earth_t, turning_radps) == 0.0);
  CHECK(rig.feed(0.3, earth_t, turning_radps) == 0.0);
  CHECK(rig.feed(rig.settings.undisturbed_s, earth_t, turning_radps) == 1.0);
}

TEST_CASE(
    "a lasting disturbance is used with a reduced weight, and a new place's field becomes the reference") {
  const Vector3d elsewhere_t(0, 30e-6, -30e-6);
  GIVEN("a body that does not turn") {
    Rig rig = that_knows_earth();
    THEN("the field is used with a reduced weight in the end") {
      CHECK(rig.feed(rig.settings.longest_rejection_s - 1.0, elsewhere_t, 0.0) == 0.0);
      CHECK(rig.feed(2.0, elsewhere_t, 0.0) == rig.settings.late_share);
    }
  }
  GIVEN("a body that turns") {
    Rig rig = that_knows_earth();
    THEN("the field becomes the reference") {
      CHECK(rig.feed(rig.settings.new_field_s - 1.0, elsewhere_t, turning_radps) == 0.0);
      CHECK(rig.feed(2.0, elsewhere_t, turning_radps) == 1.0);
      CHECK(rig.state.reference.level_t == Approx(30e-6).epsilon(0.01));
    }
  }
}

TEST_CASE("a magnet that comes near turns the heading by a small part of what it would without rejection") {
  const auto heading_deg = [](double norm_tolerance) {
    Adaptive filter;
    Adaptive::Settings settings;
    settings.magnetic.norm_tolerance = norm_tolerance;
    if (norm_tolerance >= 1.0) settings.magnetic.dip_tolerance_deg = 90.0;
    Measurement<double> measurement;
    measurement.dt_s = 0.01;
    Quaterniond truth = Quaterniond::Identity();
    for (int i = 0; i < 4000; ++i) {
      // Turning to and fro about the vertical; the magnet is near for the last 10 s.
      measurement.angular_velocity_body_radps.z() = std::cos(0.01 * i);
      truth = truth * geometry::rotation_by(measurement.angular_velocity_body_radps * 0.01);
      const Vector3d magnet_t = i > 3000 ? Vector3d(40e-6, 0, 0) : Vector3d::Zero();
      measurement.specific_force_body_mps2 = {0, 0, 9.80665};
      measurement.magnetic_field_body_t = truth.conjugate() * (earth_t + magnet_t);
      filter.update(settings, measurement);
    }
    return filter.orientation().angularDistance(truth) / geometry::radians_per_degree;
  };
  CHECK(heading_deg(MagneticSettings{}.norm_tolerance) < 3.0);
  CHECK(heading_deg(1.0) > 20.0);  // of 63° if every field is believed
}

}  // namespace magnetic_test
