/// A beacon that was switched off becomes stale, then is gone.

#include "ros2/relay/presence.hpp"

#include <catch2/catch.hpp>

namespace presence_test {

using namespace sonopose;
using ros2::relay::Presence;
using State = Presence::State;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("a beacon without samples becomes stale, and then leaves") {
  GIVEN("a beacon with poses at 100 s") {
    Presence presence({}, SteadyTime{0});
    const auto at = [](TimeNs time_s) { return SteadyTime{time_s * second_ns}; };
    observation::BeaconView view;
    view.poses = 100;
    presence.update(view, false, at(100));
    CHECK(presence.state(at(100)) == State::present);
    WHEN("it is switched off, and its bridge still publishes its status") {
      view.poses = 0;
      view.bridge.emplace();
      for (TimeNs time_s = 101; time_s <= 140; ++time_s) presence.update(view, true, at(time_s));
      THEN("it is stale after 5 s and gone after 30 s") {
        CHECK(presence.state(at(105)) == State::present);
        CHECK(presence.state(at(106)) == State::stale);
        CHECK(presence.state(at(130)) == State::stale);
        CHECK(presence.state(at(131)) == State::gone);
      }
      AND_WHEN("it returns with fixes") {
        view.bridge->fix_rate_hz = 8;
        presence.update(view, true, at(150));
        THEN("it is present") {
          CHECK(presence.state(at(150)) == State::present);
        }
      }
      AND_WHEN("its last status, with rates, is old because its bridge ended") {
        view.bridge->imu_rate_hz = 100;
        presence.update(view, false, at(150));
        THEN("it remains gone") {
          CHECK(presence.state(at(150)) == State::gone);
        }
      }
    }
  }
}

}  // namespace presence_test
