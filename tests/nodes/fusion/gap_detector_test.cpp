/// A wait for a lost event is reported once.

#include "fusion/gap_detector.hpp"

#include <catch2/catch.hpp>

namespace gap_detector_test {

using namespace sonopose;
using Catch::Contains;
using fusion::GapDetector;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("a wait for a missing event is text after five seconds, once") {
  GapDetector detector;
  const auto at = [&detector](TimeNs time_s, std::uint64_t missing, std::size_t held,
                              BeaconAddress address = 7) {
    return detector.on(address, collation::LosslessCollator::Gap{missing, held},
                       SteadyTime{time_s * second_ns});
  };
  GIVEN("events that wait for the first one") {
    CHECK_FALSE(at(100, 1, 80));
    CHECK_FALSE(at(104, 1, 400));
    WHEN("it does not come") {
      const auto text = at(105, 1, 500);
      THEN("it is reported once, with beacon, event and number of waiting events") {
        REQUIRE(text);
        CHECK_THAT(*text,
                   Contains("beacon 7: waiting for event 1, 500 events waiting") && Contains("--rate 0"));
        CHECK_FALSE(at(106, 1, 600));
        CHECK_FALSE(at(200, 1, 6000));
      }
      THEN("a later missing event is reported too, after the same time") {
        CHECK_FALSE(at(300, 900, 1));
        CHECK_FALSE(at(304, 900, 2));
        CHECK(at(305, 900, 3));
      }
    }
    WHEN("it comes") {
      CHECK_FALSE(detector.on(7, std::nullopt, SteadyTime{104 * second_ns}));
      THEN("a later wait starts from zero") {
        CHECK_FALSE(at(105, 1, 500));
        CHECK(at(110, 1, 500));
      }
    }
    WHEN("a consumer had to be waited for meanwhile") {
      detector.start_over();
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

}  // namespace gap_detector_test
