#include "presence/silence.hpp"

#include <catch2/catch.hpp>

namespace silence_test {

using namespace sonopose;
using namespace sonopose::presence;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs deadline_ns = 100 * ms;

SCENARIO("a silence is reported once when it begins and once when it ends") {
  Silence silence;
  silence.on_sample(SteadyTime{1000 * ms});
  CHECK_FALSE(silence.has_changed(SteadyTime{1100 * ms}, deadline_ns));
  CHECK_FALSE(silence.find_change(SteadyTime{1100 * ms}, deadline_ns));
  CHECK(silence.has_changed(SteadyTime{1101 * ms}, deadline_ns));
  const auto begin = silence.find_change(SteadyTime{1101 * ms}, deadline_ns);
  REQUIRE(begin);
  CHECK(begin->silent);
  CHECK(begin->lasted_s == Approx(0.101));
  CHECK(silence.is_silent());
  CHECK_FALSE(silence.has_changed(SteadyTime{1150 * ms}, deadline_ns));
  CHECK_FALSE(silence.find_change(SteadyTime{1150 * ms}, deadline_ns));
  silence.on_sample(SteadyTime{1500 * ms});
  CHECK(silence.has_changed(SteadyTime{1500 * ms}, deadline_ns));
  const auto end = silence.find_change(SteadyTime{1500 * ms}, deadline_ns);
  REQUIRE(end);
  CHECK_FALSE(end->silent);
  CHECK(end->lasted_s == Approx(0.5));
  CHECK_FALSE(silence.is_silent());
}

SCENARIO("a stream that has not begun is not silent") {
  Silence silence;
  CHECK_FALSE(silence.find_change(SteadyTime{5000 * ms}, deadline_ns));
  CHECK_FALSE(silence.is_silent());
}

}  // namespace silence_test
