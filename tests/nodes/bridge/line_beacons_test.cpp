#include "bridge/line_beacons.hpp"

#include <catch2/catch.hpp>

namespace line_beacons_test {

using namespace sonopose;
using bridge::LineBeacons;

constexpr TimeNs second_ns = 1'000'000'000;
const SteadyTime start = SteadyTime{} + second_ns;
using Addresses = std::vector<std::uint8_t>;

SCENARIO("a line has a bounded number of beacons") {
  GIVEN("space for two beacons, one of which has sent a hundred packets") {
    LineBeacons beacons(2);
    for (int i = 0; i < 100; ++i) CHECK(beacons.accepts(7, start));
    CHECK(beacons.accepts(8, start));
    WHEN("a third one sends") {
      CHECK_FALSE(beacons.accepts(9, start));
      THEN("it is refused and reported") {
        CHECK(
            beacons.refusals() ==
            "1 address is ignored: the limit is 2 beacons at a time and 32 since the start (--max-beacons)");
      }
    }
    WHEN("both are silent for five seconds") {
      CHECK(beacons.remove_gone(start + 5 * second_ns).empty());
      THEN("the one that was hardly heard is gone, and another takes its place") {
        CHECK(beacons.remove_gone(start + 5 * second_ns + 1) == Addresses{8});
        CHECK(beacons.remove_gone(start + 5 * second_ns + 1).empty());
        CHECK(beacons.accepts(9, start + 6 * second_ns));
      }
    }
    WHEN("both are silent for a minute, and one returns") {
      CHECK(beacons.remove_gone(start + 60 * second_ns + 1) == Addresses{7, 8});
      CHECK(beacons.accepts(7, start + 61 * second_ns));
      THEN("it stays as long as it sends") {
        CHECK(beacons.remove_gone(start + 62 * second_ns).empty());
      }
    }
  }
}

}  // namespace line_beacons_test
