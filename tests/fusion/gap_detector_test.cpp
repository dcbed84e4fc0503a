/// Who waits in vain for an event is told so, once.

#include "fusion/gap_detector.hpp"

#include <catch2/catch.hpp>

using namespace sonopose;
using Catch::Contains;
using fusion::GapDetector;

namespace {

constexpr TimeNs second_ns = 1'000'000'000;

}  // namespace

SCENARIO("a wait for a missing event is told after five seconds, once") {
  GapDetector watch;
  const auto at = [&watch](TimeNs time_s, std::uint64_t missing, std::size_t held,
                           BeaconAddress address = 7) {
    return watch.on(address, collation::LosslessCollator::Gap{missing, held}, SteadyTime{time_s * second_ns});
  };
  GIVEN("events that wait for the first one") {
    CHECK_FALSE(at(100, 1, 80));
    CHECK_FALSE(at(104, 1, 400));
    WHEN("it does not come") {
      const auto told = at(105, 1, 500);
      THEN("that is told, with beacon, event and number of those held, and not again") {
        REQUIRE(told);
        CHECK_THAT(*told, Contains("beacon 7: waiting for event 1, 500 events held") && Contains("--rate 0"));
        CHECK_FALSE(at(106, 1, 600));
        CHECK_FALSE(at(200, 1, 6000));
      }
      THEN("another one that is missing later is told too, after as long") {
        CHECK_FALSE(at(300, 900, 1));
        CHECK_FALSE(at(304, 900, 2));
        CHECK(at(305, 900, 3));
      }
    }
    WHEN("it comes") {
      CHECK_FALSE(watch.on(7, std::nullopt, SteadyTime{104 * second_ns}));
      THEN("a later wait begins anew") {
        CHECK_FALSE(at(105, 1, 500));
        CHECK(at(110, 1, 500));
      }
    }
    WHEN("a consumer had to be waited for meanwhile") {
      watch.start_over();
      THEN("that time does not count") {
        CHECK_FALSE(at(105, 1, 500));
        CHECK(at(110, 1, 500));
      }
    }
    WHEN("another beacon waits too") {
      CHECK_FALSE(at(105, 1, 10, 8));
      THEN("each has its own time") {
        CHECK(at(105, 1, 500));
        CHECK_FALSE(at(109, 1, 20, 8));
        CHECK(at(110, 1, 20, 8));
      }
    }
  }
}
