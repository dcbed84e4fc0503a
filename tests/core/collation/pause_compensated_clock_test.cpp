#include <sonopose/collation/collator.hpp>
#include <sonopose/collation/pause_compensated_clock.hpp>

#include <catch2/catch.hpp>

namespace pause_compensated_clock_test {

using namespace sonopose;
using namespace sonopose::collation;

constexpr TimeNs ms = 1'000'000;

Event imu(std::uint64_t sequence) {
  ImuSample sample;
  sample.sequence = sequence;
  return sample;
}

SCENARIO("a pause of the process gives up no event") {
  GIVEN("a collator with event 3 waiting for event 2") {
    PauseCompensatedClock clock;
    Collator collator(5 * ms);
    SteadyTime now{1000 * ms};
    collator.push(imu(1), clock.on_poll(now));
    collator.push(imu(3), clock.on_poll(now += ms));
    WHEN("the process is stopped for 200 ms, and then takes 4 before 2") {
      now += 200 * ms;
      collator.push(imu(4), clock.on_poll(now));
      const auto in_line = collator.push(imu(2), clock.on_poll(now += ms));
      THEN("2, 3 and 4 are in line") {
        CHECK(in_line.size() == 3);
        CHECK(collator.counters().lost == 0);
        CHECK(collator.counters().duplicated == 0);
      }
    }
    WHEN("the process looks for events for 7 ms without receiving 2") {
      for (std::uint64_t sequence = 4; sequence <= 10; ++sequence) {
        collator.push(imu(sequence), clock.on_poll(now += ms));
      }
      THEN("2 is given up") {
        CHECK(collator.counters().lost == 1);
      }
    }
  }
}

}  // namespace pause_compensated_clock_test
