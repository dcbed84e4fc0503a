#include "doctor/probe/beacon_probe.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <optional>

namespace longest_rest_test {

using namespace sonopose;
using namespace sonopose::doctor;

constexpr TimeNs begin_ns = 1'000'000'000'000;
constexpr TimeNs imu_period_ns = 10'000'000;
constexpr TimeNs fix_period_ns = 100'000'000;
const Vector3d gravity_mps2(0, 0, 9.8);

/// A beacon that rests on its side at the origin, unless a test changes that.
struct Beacon {
  std::function<Vector3d(double)> force_mps2 = [](double) { return Vector3d(9.8, 0, 0); };
  std::function<Vector3d(double)> rate_radps = [](double) { return Vector3d(0, 0, 0); };
  std::function<Vector3d(double)> position_m = [](double) { return Vector3d(0, 0, 0); };

  [[nodiscard]] std::optional<rules::RestObservation> rest_after(double duration_s) const {
    probe::BeaconProbe probe;
    probe.begin(begin_ns, {});
    const TimeNs end_ns = begin_ns + to_ns(duration_s);
    for (TimeNs at_ns = begin_ns; at_ns < end_ns; at_ns += imu_period_ns) {
      const double time_s = seconds_between(begin_ns, at_ns);
      ImuSample imu;
      imu.specific_force_body_mps2 = force_mps2(time_s);
      imu.angular_velocity_body_radps = rate_radps(time_s);
      probe.on(imu, at_ns, 1);
      if ((at_ns - begin_ns) % fix_period_ns != 0) continue;
      UltrasonicFix fix;
      fix.position_world_m = position_m(time_s);
      probe.on(fix, at_ns);
    }
    return probe.observation(end_ns, {}).rest;
  }
};

/// Returns true if the means are those of the beacon at rest on its side.
bool is_on_its_side(const std::optional<rules::RestObservation>& rest) {
  return rest && rest->mean_force_body_mps2.isApprox(Vector3d(9.8, 0, 0), 1e-6);
}

TEST_CASE("A single fix or reading far off does not hide the rest of a beacon") {
  Beacon beacon;
  CHECK(is_on_its_side(beacon.rest_after(8)));
  SECTION("fix") {
    beacon.position_m = [](double t) { return Vector3d(std::abs(t - 4.0) < 0.05 ? 3.0 : 0.0, 0, 0); };
    CHECK(is_on_its_side(beacon.rest_after(8)));
  }
  SECTION("reading") {
    beacon.force_mps2 = [](double t) { return Vector3d(std::abs(t - 4.5) < 0.005 ? 90.0 : 9.8, 0, 0); };
    CHECK(is_on_its_side(beacon.rest_after(8)));
  }
}

TEST_CASE("A beacon that moves for a part of the look is judged by the longest part at rest") {
  Beacon beacon;
  // Moves from 3 s to 5 s, then stands upright for a longer time than before.
  beacon.force_mps2 = [](double t) -> Vector3d {
    if (t < 3) return {9.8, 0, 0};
    return t < 5 ? Vector3d(9.8, 5.0 * std::sin(20 * t), 0) : gravity_mps2;
  };
  beacon.position_m = [](double t) { return Vector3d(t < 3 ? 0.0 : t < 5 ? 2.0 * (t - 3) : 4.0, 0, 0); };
  const auto rest = beacon.rest_after(9);
  REQUIRE(rest);
  CHECK(rest->mean_force_body_mps2.isApprox(gravity_mps2, 1e-6));
}

TEST_CASE("Of a look of some minutes, a move before the last two does not count") {
  Beacon beacon;
  beacon.position_m = [](double t) { return Vector3d(t < 20 ? 10.0 : 0.0, 0, 0); };
  CHECK(is_on_its_side(beacon.rest_after(180)));
}

TEST_CASE("A beacon that moves does not rest") {
  Beacon beacon;
  SECTION("vibrating") {
    beacon.force_mps2 = [](double t) { return Vector3d(9.8, 0.6 * std::sin(90 * t), 0); };
  }
  SECTION("turning to and fro") {
    beacon.rate_radps = [](double t) { return Vector3d(0, 0, 0.1 * std::sin(5 * t)); };
  }
  SECTION("turning at a constant rate") {
    beacon.rate_radps = [](double) { return Vector3d(0, 0, 2.0); };
  }
  SECTION("at a constant speed on a straight line, which the IMU does not show") {
    beacon.position_m = [](double t) { return Vector3d(0.5 * t, 0, 0); };
  }
  CHECK_FALSE(beacon.rest_after(8));
}

TEST_CASE("A pause of one second is no rest, unless the look is as short") {
  Beacon beacon;
  CHECK(is_on_its_side(beacon.rest_after(0.8)));
  beacon.force_mps2 = [](double t) {
    return Vector3d(9.8, t > 3 && t < 4 ? 0.0 : 5.0 * std::sin(20 * t), 0);
  };
  CHECK_FALSE(beacon.rest_after(8));
}

}  // namespace longest_rest_test
