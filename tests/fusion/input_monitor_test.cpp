#include "fusion/input_monitor.hpp"

#include "process/silence_detector.hpp"

#include <catch2/catch.hpp>

namespace input_monitor_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::process;

constexpr TimeNs ms = 1'000'000;

SCENARIO("missed deadlines are counted per beacon, the loss of a bridge for each of its beacons") {
  InputMonitor monitor;
  monitor.on_imu(7, 100);
  monitor.on_imu(8, 100);
  monitor.on_imu(9, 200);
  monitor.on_deadline_missed(7, &InputCounters::imu_deadlines_missed, 2);
  monitor.on_deadline_missed(7, &InputCounters::fix_deadlines_missed, 1);
  monitor.on_deadline_missed(55, &InputCounters::imu_deadlines_missed, 1);
  CHECK(monitor.counters(7).imu_deadlines_missed == 2);
  CHECK(monitor.counters(7).fix_deadlines_missed == 1);
  CHECK(monitor.counters(8).imu_deadlines_missed == 0);
  CHECK(monitor.counters(55).imu_deadlines_missed == 0);  // unknown beacon
  monitor.on_bridge_lost(100);
  CHECK(monitor.counters(7).bridge_losses == 1);
  CHECK(monitor.counters(8).bridge_losses == 1);
  CHECK(monitor.counters(9).bridge_losses == 0);
  WHEN("a beacon has moved to another bridge") {
    monitor.on_imu(7, 200);
    monitor.on_bridge_lost(100);
    CHECK(monitor.counters(7).bridge_losses == 1);
  }
}

SCENARIO("a silence is reported once when it begins and once when it ends") {
  SilenceDetector monitor(100 * ms);
  std::vector<SilenceDetector::Change> changes;
  const auto look = [&](TimeNs now_ns) {
    changes.clear();
    monitor.find_changes(SteadyTime{now_ns}, changes);
    return changes.size();
  };
  monitor.on_sample(7, SteadyTime{1000 * ms});
  monitor.on_sample(8, SteadyTime{1090 * ms});
  CHECK(look(1100 * ms) == 0);
  REQUIRE(look(1101 * ms) == 1);
  CHECK(changes[0].address == 7);
  CHECK(changes[0].silent);
  CHECK(changes[0].lasted_s == Approx(0.101));
  CHECK(monitor.is_silent(7));
  CHECK_FALSE(monitor.is_silent(8));
  CHECK(look(1150 * ms) == 0);
  monitor.on_sample(7, SteadyTime{1500 * ms});
  monitor.on_sample(8, SteadyTime{1170 * ms});
  REQUIRE(look(1500 * ms) == 2);
  const auto& seven = changes[0].address == 7 ? changes[0] : changes[1];
  CHECK_FALSE(seven.silent);
  CHECK(seven.lasted_s == Approx(0.5));
}

}  // namespace input_monitor_test
