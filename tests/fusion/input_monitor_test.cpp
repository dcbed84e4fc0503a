#include "fusion/input_monitor.hpp"

#include "process/silence_detector.hpp"

#include <catch2/catch.hpp>

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::process;

namespace {
constexpr TimeNs ms = 1'000'000;
}

SCENARIO("missed deadlines are the beacon's own, a bridge's death that of all it serves") {
  InputMonitor watch;
  watch.on_imu(7, 100);
  watch.on_imu(8, 100);
  watch.on_imu(9, 200);
  watch.on_deadline_missed(7, &InputCounters::imu_deadlines_missed, 2);
  watch.on_deadline_missed(7, &InputCounters::fix_deadlines_missed, 1);
  watch.on_deadline_missed(55, &InputCounters::imu_deadlines_missed, 1);
  CHECK(watch.counters(7).imu_deadlines_missed == 2);
  CHECK(watch.counters(7).fix_deadlines_missed == 1);
  CHECK(watch.counters(8).imu_deadlines_missed == 0);
  CHECK(watch.counters(55).imu_deadlines_missed == 0);  // never heard of: no beacon of ours
  watch.on_bridge_lost(100);
  CHECK(watch.counters(7).bridge_losses == 1);
  CHECK(watch.counters(8).bridge_losses == 1);
  CHECK(watch.counters(9).bridge_losses == 0);
  WHEN("a beacon has moved to another bridge") {
    watch.on_imu(7, 200);
    watch.on_bridge_lost(100);
    CHECK(watch.counters(7).bridge_losses == 1);
  }
}

SCENARIO("a silence is told once when it begins and once when it ends") {
  SilenceDetector watch(100 * ms);
  std::vector<SilenceDetector::Change> changes;
  const auto look = [&](TimeNs now_ns) {
    changes.clear();
    watch.find_changes(SteadyTime{now_ns}, changes);
    return changes.size();
  };
  watch.on_sample(7, SteadyTime{1000 * ms});
  watch.on_sample(8, SteadyTime{1090 * ms});
  CHECK(look(1100 * ms) == 0);
  REQUIRE(look(1101 * ms) == 1);
  CHECK(changes[0].address == 7);
  CHECK(changes[0].silent);
  CHECK(changes[0].lasted_s == Approx(0.101));
  CHECK(watch.is_silent(7));
  CHECK_FALSE(watch.is_silent(8));
  CHECK(look(1150 * ms) == 0);
  watch.on_sample(7, SteadyTime{1500 * ms});
  watch.on_sample(8, SteadyTime{1170 * ms});
  REQUIRE(look(1500 * ms) == 2);
  const auto& seven = changes[0].address == 7 ? changes[0] : changes[1];
  CHECK_FALSE(seven.silent);
  CHECK(seven.lasted_s == Approx(0.5));
}
