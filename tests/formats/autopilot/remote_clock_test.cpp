#include "autopilot/remote_clock.hpp"

#include <catch2/catch.hpp>

namespace remote_clock_test {

using namespace sonopose;
using autopilot::RemoteClock;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs second = 1000 * ms;
constexpr HostTime host_ns = 1'700'000'000 * second;
constexpr SteadyTime begin{100 * second};

SCENARIO("stamps are in the clock of the autopilot") {
  RemoteClock clock;
  GIVEN("no message") {
    THEN("the clock is unknown") {
      CHECK_FALSE(clock.at(host_ns, begin));
    }
  }
  GIVEN("an agent on this machine, whose messages take 3 to 20 ms") {
    for (const TimeNs late : {20 * ms, 3 * ms, 12 * ms}) clock.on(host_ns - late, host_ns, begin);
    THEN("the clock is that of the host, without the delay") {
      CHECK(clock.at(host_ns, begin) == host_ns);
    }
    WHEN("all messages take 90 ms for a while") {
      for (int i = 0; i < 20; ++i) clock.on(host_ns - 90 * ms, host_ns, begin);
      THEN("the clock stays") {
        CHECK(clock.at(host_ns, begin) == host_ns);
      }
    }
    WHEN("all take more than 100 ms") {
      for (int i = 0; i < 20; ++i) clock.on(host_ns - 110 * ms, host_ns, begin);
      THEN("that is another clock") {
        CHECK(clock.at(host_ns, begin) == host_ns - 110 * ms);
      }
    }
  }
  GIVEN("a clock that is 90 ms behind, or 20 ms ahead") {
    const TimeNs offset_ns = GENERATE(-90 * ms, 20 * ms);
    clock.on(host_ns + offset_ns, host_ns, begin);
    THEN("it is another one") {
      CHECK(clock.at(host_ns, begin) == host_ns + offset_ns);
    }
  }
  GIVEN("an autopilot that started 500 s ago, whose messages take 3 to 20 ms") {
    for (const TimeNs late : {20 * ms, 3 * ms, 12 * ms}) clock.on(500 * second - late, host_ns, begin);
    THEN("the fastest message counts") {
      CHECK(clock.at(host_ns, begin) == 500 * second - 3 * ms);
    }
    THEN("a time before its start has no stamp") {
      CHECK_FALSE(clock.at(host_ns - 600 * second, begin));
    }
    WHEN("it starts again") {
      clock.on(2 * second, host_ns + second, begin + second);
      THEN("its new clock counts at once") {
        CHECK(clock.at(host_ns + second, begin + second) == 2 * second);
      }
    }
    WHEN("it has been silent for 3 s") {
      THEN("the clock is lost") {
        CHECK(clock.at(host_ns, begin + 3 * second));
        CHECK_FALSE(clock.at(host_ns, begin + 3 * second + 1));
      }
    }
  }
}

}  // namespace remote_clock_test
