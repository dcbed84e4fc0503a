#include "process/silence_detector.hpp"

#include <catch2/catch.hpp>

namespace silence_detector_test {

using namespace sonopose;
using namespace sonopose::process;

constexpr TimeNs ms = 1'000'000;

SCENARIO("a silence is reported once when it begins and once when it ends") {
  SilenceDetector detector(100 * ms);
  std::vector<SilenceDetector::Change> changes;
  const auto look = [&](TimeNs now_ns) {
    changes.clear();
    detector.find_changes(SteadyTime{now_ns}, changes);
    return changes.size();
  };
  detector.on_sample(7, SteadyTime{1000 * ms});
  detector.on_sample(8, SteadyTime{1090 * ms});
  CHECK(look(1100 * ms) == 0);
  REQUIRE(look(1101 * ms) == 1);
  CHECK(changes[0].address == 7);
  CHECK(changes[0].silent);
  CHECK(changes[0].lasted_s == Approx(0.101));
  CHECK(look(1150 * ms) == 0);
  detector.on_sample(7, SteadyTime{1500 * ms});
  detector.on_sample(8, SteadyTime{1170 * ms});
  REQUIRE(look(1500 * ms) == 2);
  const auto& seven = changes[0].address == 7 ? changes[0] : changes[1];
  CHECK_FALSE(seven.silent);
  CHECK(seven.lasted_s == Approx(0.5));
}

SCENARIO("a stream that has not begun is not silent") {
  Silence imu;
  CHECK_FALSE(imu.find_change(SteadyTime{5000 * ms}, 100 * ms));
  CHECK_FALSE(imu.is_silent());
}

}  // namespace silence_detector_test
