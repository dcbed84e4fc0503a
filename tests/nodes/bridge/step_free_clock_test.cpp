#include "bridge/step_free_clock.hpp"

#include <catch2/catch.hpp>

namespace step_free_clock_test {

using namespace sonopose;
using bridge::StepFreeClock;

constexpr TimeNs ms = 1'000'000;
constexpr HostTime start_ns = 1'700'000'000'000'000'000;
constexpr SteadyTime start{5'000'000'000};

SCENARIO("a clock without steps measures how far the host's was set") {
  StepFreeClock clock(start_ns, start);
  const SteadyTime later = start + 1000 * ms;
  WHEN("it is not set") {
    clock.compare(later, start_ns + 1000 * ms + 15'000, later + 30'000);
    CHECK(clock.host_ahead_ns() < ms / 10);
    CHECK(clock.steps() == 0);
    CHECK(clock.at(later) == start_ns + 1000 * ms);
  }
  WHEN("it is set back and then ahead") {
    clock.compare(later, start_ns + 1000 * ms - 300 * ms, later);
    CHECK(clock.host_ahead_ns() == -300 * ms);
    clock.compare(later + ms, start_ns + 1001 * ms + 8000 * ms, later + ms);
    CHECK(clock.host_ahead_ns() == 8000 * ms);
    CHECK(clock.steps() == 2);
    CHECK(clock.at(later) == start_ns + 1000 * ms);
  }
  WHEN("it is set by little") {
    clock.compare(later, start_ns + 1000 * ms + 50 * ms, later);
    CHECK(clock.host_ahead_ns() == 4 * ms);  // slewed by 0.4 % of a second
    CHECK(clock.steps() == 0);
    for (TimeNs s = 2; s < 20; ++s) {
      const SteadyTime time = start + s * 1000 * ms;
      clock.compare(time, start_ns + s * 1000 * ms + 50 * ms, time);
    }
    CHECK(clock.host_ahead_ns() == 50 * ms);
  }
  WHEN("the thread is suspended between the readings") {
    clock.compare(later, start_ns + 1400 * ms, later + 400 * ms);
    CHECK(clock.host_ahead_ns() == 0);
    CHECK(clock.steps() == 0);
  }
}

}  // namespace step_free_clock_test
