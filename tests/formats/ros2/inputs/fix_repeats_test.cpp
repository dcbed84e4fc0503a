#include "ros2/inputs/fix_repeats.hpp"

#include <catch2/catch.hpp>

namespace fix_repeats_test {

using namespace sonopose;
using ros2::FixRepeats;

constexpr TimeNs ms = 1'000'000;

UltrasonicFix fix_at(TimeNs time_ns, double x_m) {
  UltrasonicFix fix;
  fix.emission_time_ns = time_ns;
  fix.position_world_m = {x_m, 2, 3};
  return fix;
}

/// Feeds fixes every 20 ms whose position changes with every `period`-th one by `step_m`; returns the new
/// ones.
int new_ones(FixRepeats& repeats, int count, int period, double step_m, TimeNs begin_ns = 0,
             double begin_m = 0) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    const int step = i / period;
    if (repeats.is_new(fix_at(begin_ns + TimeNs{i} * 20 * ms, begin_m + step * step_m))) ++found;
  }
  return found;
}

SCENARIO("a driver that repeats its last position is recognised in motion") {
  FixRepeats repeats;
  GIVEN("10 positions per second at 1 m/s, sent 50 times per second") {
    const int learning = new_ones(repeats, 20, 5, 0.1);
    THEN("each counts once, after the first few") {
      CHECK(repeats.are_known());
      CHECK(learning < 20);
      CHECK(new_ones(repeats, 500, 5, 0.1, 400 * ms, 0.4) == 100);
    }
    WHEN("it then stands still for 10 s") {
      const int at_rest = new_ones(repeats, 500, 500, 0, 400 * ms, 0.4);
      THEN("a position counts again every half second, so that the track does not end") {
        CHECK(at_rest >= 19);
        CHECK(at_rest <= 21);
      }
    }
  }
  GIVEN("a system that reports a body at rest in whole centimetres, which then moves") {
    THEN("every fix counts") {
      CHECK(new_ones(repeats, 500, 7, 0.01) == 500);
      CHECK(new_ones(repeats, 500, 500, 0, 10'000 * ms, 5) == 500);
      CHECK(new_ones(repeats, 500, 1, 0.05, 20'000 * ms, 5) == 500);
      CHECK_FALSE(repeats.are_known());
    }
  }
  GIVEN("the same message twice") {
    THEN("it counts once, even at rest") {
      CHECK(repeats.is_new(fix_at(0, 1)));
      CHECK_FALSE(repeats.is_new(fix_at(0, 1)));
      CHECK(repeats.is_new(fix_at(20 * ms, 1)));
    }
  }
}

}  // namespace fix_repeats_test
