#include "monitor/counters_since.hpp"

#include <catch2/catch.hpp>

namespace counters_since_test {

using namespace sonopose;
using namespace sonopose::monitor;
using observation::BeaconView;

/// A beacon whose bridge and fusion have counted this much, and the monitor a tenth.
BeaconView counted(std::uint64_t count, std::uint64_t fusion_id = 1) {
  BeaconView view;
  view.address = 7;
  view.bridge.emplace();
  view.bridge->frames = 10 * count;
  view.bridge->crc_errors = count;
  FusionStatus fusion;
  fusion.fusion_id = fusion_id;
  fusion.events_lost = count;
  view.fusions = {fusion};
  view.fusion = fusion;
  view.deadlines_missed = count / 10;
  return view;
}

/// Counters shown of the bridge, the fusion and the monitor itself.
struct Shown {
  std::uint64_t crc_errors;
  std::uint64_t events_lost;
  std::uint64_t deadlines_missed;
  bool operator==(const Shown&) const = default;
};
Shown shown(CountersSince& counters, const BeaconView& received, double running_s) {
  std::vector<BeaconView> views{received};
  counters.apply(views, running_s);
  return {views[0].bridge->crc_errors, views[0].fusion->events_lost, views[0].deadlines_missed};
}

SCENARIO("counters begin with the monitor") {
  CountersSince counters;
  GIVEN("processes that were there before the monitor") {
    CHECK(shown(counters, counted(100), 1.0) == Shown{0, 0, 10});
    THEN("their increase is shown") {
      CHECK(shown(counters, counted(130), 9.0) == Shown{30, 30, 13});
    }
    THEN("a restarted process counts from its own start") {
      CHECK(shown(counters, counted(20), 9.0).crc_errors == 20);
      CHECK(shown(counters, counted(25), 10.0).crc_errors == 25);
    }
    THEN("after a clear, all begin at zero") {
      counters.clear({counted(130)});
      CHECK(shown(counters, counted(130), 9.0) == Shown{0, 0, 0});
      CHECK(shown(counters, counted(150), 10.0) == Shown{20, 20, 2});
    }
    THEN("a second fusion that starts later counts from its own start") {
      CHECK(shown(counters, counted(101, 2), 9.0).events_lost == 101);
    }
  }
  GIVEN("a beacon that appears later") {
    THEN("everything that was counted of it is shown") {
      CHECK(shown(counters, counted(100), 9.0) == Shown{100, 100, 10});
    }
  }
}

}  // namespace counters_since_test
