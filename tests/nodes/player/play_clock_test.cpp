#include "player/play_clock.hpp"

#include <catch2/catch.hpp>

#include <limits>
#include <stdexcept>

namespace sonopose::player::test::play_clock_test {

constexpr TimeNs second = 1'000'000'000;
constexpr SteadyTime now{5 * second};

TEST_CASE("Messages are due at the recorded times, at the rate") {
  PlayClock clock(2.0);
  clock.begin(100 * second, now);
  CHECK(clock.due(100 * second) == now);
  CHECK(clock.due(104 * second) == now + 2 * second);
  CHECK(clock.due(99 * second) == now);  // a log time that steps back is due immediately
  CHECK(*clock.due(std::numeric_limits<std::uint64_t>::max()) > now);
}

TEST_CASE("At the rate 0 everything is due at once") {
  PlayClock clock(0.0);
  clock.begin(100 * second, now);
  CHECK(clock.due(1'000 * second) == now);
}

TEST_CASE("What is left out is not waited for") {
  PlayClock clock(2.0);
  clock.begin(100 * second, now);
  clock.leave_out(1'000'000 * second);
  CHECK(clock.due(1'000'104 * second) == now + 2 * second);
  clock.leave_out(10 * second);
  CHECK(clock.due(1'000'120 * second) == now + 5 * second);
}

TEST_CASE("A pause moves what follows it") {
  PlayClock clock(1.0);
  clock.begin(100 * second, now);
  clock.pause(now + 1 * second);
  CHECK(clock.is_paused());
  CHECK_FALSE(clock.due(102 * second));
  SECTION("by its length") {
    clock.resume(now + 11 * second);
    CHECK(clock.due(102 * second) == now + 12 * second);
  }
  SECTION("and steps in it are not waited for again") {
    clock.step_to(102 * second);
    clock.step_to(103 * second);
    clock.resume(now + 11 * second);
    CHECK(clock.due(104 * second) == now + 12 * second);
  }
  SECTION("a repetition that begins in it waits for its end") {
    clock.begin(100 * second, now + 2 * second);
    CHECK_FALSE(clock.due(100 * second));
    clock.resume(now + 11 * second);
    CHECK(clock.due(101 * second) == now + 12 * second);
  }
}

TEST_CASE("A rate that is none is refused") {
  CHECK_THROWS_AS(PlayClock(-1.0), std::invalid_argument);
  CHECK_THROWS_AS(PlayClock(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
}

}  // namespace sonopose::player::test::play_clock_test
