#include <sonopose/estimation/kalman/rest.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace rest_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;

bool completes_still_window(RestState& state, double time_s, const Vector3d& rate, const Vector3d& force) {
  const TimeNs time_ns = epoch_ns + to_ns(time_s);
  return rest::add_sample(state, time_ns, rate, force) &&
         rest::end_window(state, time_ns, Vector3d::Zero(), 0.0);
}

/// Counts still windows within `duration_s` of a body that shakes with this amplitude at 5 Hz.
int still_windows(double duration_s, double shake_mps2, double turn_radps) {
  RestState state;
  int still = 0;
  for (int k = 0; k < static_cast<int>(100.0 * duration_s); ++k) {
    const double time_s = 0.01 * k;
    const Vector3d force(shake_mps2 * std::sin(31.4 * time_s), 0.0, 9.8);
    const Vector3d rate(0.0, 0.0, turn_radps);
    if (completes_still_window(state, time_s, rate, force)) ++still;
  }
  return still;
}

TEST_CASE("rest is a body that neither shakes nor turns") {
  CHECK(still_windows(2.5, 0.0, 0.0) == 4);
  CHECK(still_windows(2.5, 0.5, 0.0) == 0);
  CHECK(still_windows(2.5, 0.0, 0.1) == 0);  // a steady turn
}

TEST_CASE("a smooth cruise is no standstill once its fixes have moved") {
  RestState state;
  for (int k = 0; k <= 60; ++k) {
    completes_still_window(state, 0.01 * k, Vector3d::Zero(), {0, 0, 9.8});
  }
  REQUIRE(state.still_windows == 1);
  RestState standing = state;
  for (int k = 0; k < 40; ++k) {
    const TimeNs time_ns = epoch_ns + to_ns(0.6 + 0.1 * k);
    rest::add_fix(state, time_ns, {0.05 * 0.1 * k, 0.0, 0.0});  // 5 cm/s
    rest::add_fix(standing, time_ns, {0.01 * std::sin(7.0 * k), 0.0, 0.0});
  }
  CHECK_FALSE(rest::fixes_stand_still(state, Vector3d::Constant(0.02), 4));
  CHECK(rest::fixes_stand_still(standing, Vector3d::Constant(0.02), 4));
}

TEST_CASE("a creep after a long rest is no standstill") {
  RestState state;
  for (int k = 0; k <= 60; ++k) {
    completes_still_window(state, 0.01 * k, Vector3d::Zero(), {0, 0, 9.8});
  }
  const auto add = [&](int k, double x_m) {
    rest::add_fix(state, epoch_ns + to_ns(0.6 + 0.1 * k), {x_m + 0.01 * std::sin(7.0 * k), 0.0, 0.0});
  };
  for (int k = 0; k < 3000; ++k) add(k, 0.0);  // five minutes
  REQUIRE(rest::fixes_stand_still(state, Vector3d::Constant(0.02), 4));
  for (int k = 3000; k < 3040; ++k) add(k, 0.05 * 0.1 * (k - 3000));  // 5 cm/s
  CHECK_FALSE(rest::fixes_stand_still(state, Vector3d::Constant(0.02), 4));
}

}  // namespace rest_test
