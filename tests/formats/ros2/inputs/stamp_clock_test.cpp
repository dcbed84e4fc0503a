#include "ros2/inputs/stamp_clock.hpp"

#include <catch2/catch.hpp>

namespace stamp_clock_test {

using namespace sonopose;
using ros2::StampClock;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs now_ns = 1'800'000'000'000 * ms;
constexpr TimeNs hour_ns = 3'600'000 * ms;

SCENARIO("host times are converted to the clock of the IMU's stamps") {
  StampClock clock;
  GIVEN("no sample yet") {
    CHECK(clock.at(now_ns) == now_ns);
  }
  GIVEN("a sample of the host's clock that came late, as on a busy machine") {
    clock.on_imu(now_ns - 400 * ms, now_ns);
    CHECK(clock.at(now_ns + ms) == now_ns + ms);
  }
  GIVEN("a recording of an hour ago, that is then played from its start") {
    clock.on_imu(now_ns - hour_ns + 5000 * ms, now_ns);
    CHECK(clock.at(now_ns + ms) == now_ns - hour_ns + 5001 * ms);
  }
}

}  // namespace stamp_clock_test
