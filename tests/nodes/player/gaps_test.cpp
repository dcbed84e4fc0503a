#include "player/gaps.hpp"

#include "logging/captured_log.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>

namespace sonopose::player::test::gaps_test {

using Catch::Contains;

constexpr std::uint64_t second = 1'000'000'000;
constexpr std::uint64_t begin_ns = 1'600'000'000 * second;
constexpr std::uint64_t six_years = std::uint64_t{2190} * 86400 * second;

/// Plays messages at these times after the beginning. Returns the log.
std::string log_of(Gaps& gaps, std::initializer_list<std::uint64_t> after_ns) {
  logging::test::CapturedError error;
  gaps.begin(begin_ns);
  for (const std::uint64_t each : after_ns) gaps.advance_to(begin_ns + each);
  error.restore();
  return error.read();
}

SCENARIO("times without messages are named") {
  GIVEN("a player that shortens nothing") {
    Gaps gaps({}, 1.0, begin_ns);
    THEN("a step of the clock is named, with the option that shortens it") {
      CHECK_THAT(log_of(gaps, {12 * second / 10, six_years}),
                 Contains("no messages for 6.0 years after 1.200 s; --max-gap S shortens such gaps"));
      CHECK(gaps.shortened() == 0);
    }
    THEN("the periods of samples are not, and neither is a step back") {
      CHECK(log_of(gaps, {1 * second, 3 * second, 2 * second, 4 * second}).empty());
    }
  }
  GIVEN("a player that does not wait") {
    Gaps gaps({}, 0.0, begin_ns);
    CHECK(log_of(gaps, {six_years}).empty());
  }
  GIVEN("a recording with a gap after each message") {
    Gaps gaps({}, 1.0, begin_ns);
    std::string log;
    for (int i = 0; i < 100; ++i) log += log_of(gaps, {60 * second});
    THEN("the log has a limit, and says so") {
      CHECK(std::count(log.begin(), log.end(), '\n') == 21);
      CHECK_THAT(log, Contains("further gaps are not named"));
    }
  }
}

SCENARIO("times without messages are shortened") {
  GIVEN("a limit of half a second") {
    Gaps gaps(0.5, 1.0, begin_ns);
    gaps.begin(begin_ns);
    THEN("what exceeds it is left out, and counted") {
      CHECK(gaps.advance_to(begin_ns + second / 2) == 0);
      CHECK(gaps.advance_to(begin_ns + 2 * second) == second);
      CHECK(gaps.advance_to(begin_ns + second) == 0);  // a step back
      CHECK(gaps.advance_to(begin_ns + 2 * second + six_years) == six_years - second / 2);
      CHECK(gaps.shortened() == 2);
      CHECK(gaps.left_out_s() == Approx(static_cast<double>(six_years) * 1e-9 + 0.5));
    }
  }
  CHECK_THROWS_AS(Gaps(-1.0, 1.0, 0), std::invalid_argument);
  CHECK_THROWS_AS(Gaps(std::numeric_limits<double>::quiet_NaN(), 1.0, 0), std::invalid_argument);
}

}  // namespace sonopose::player::test::gaps_test
