#include "mavlink/sender/heartbeat_tracker.hpp"

#include "mavlink/messages.hpp"

#include <catch2/catch.hpp>

namespace heartbeat_tracker_test {

using namespace sonopose;
using mavlink::sender::HeartbeatTracker;

mavlink::Frame heartbeat_of(mavlink::Identity sender, std::uint8_t autopilot) {
  auto frame = mavlink::heartbeat(sender);
  frame.payload[5] = autopilot;
  return frame;
}

SCENARIO("the autopilot is known by its heartbeats") {
  constexpr TimeNs second = 1'000'000'000;
  HeartbeatTracker tracker;
  const SteadyTime begin{100 * second};
  GIVEN("heartbeats of a ground station") {
    CHECK_FALSE(tracker.on(heartbeat_of({255, 190}, mavlink::autopilot_none), 0, begin));
    THEN("that is no autopilot") {
      CHECK_FALSE(tracker.kind(begin));
    }
  }
  GIVEN("heartbeats of a PX4 that is system 5") {
    CHECK(tracker.on(heartbeat_of({5, 1}, mavlink::autopilot_px4), 14580, begin));
    THEN("we are a component of its vehicle") {
      CHECK(tracker.kind(begin) == mavlink::autopilot_px4);
      CHECK(tracker.own() == mavlink::Identity{5, mavlink::own_component});
    }
    WHEN("another vehicle is heard too") {
      CHECK_FALSE(tracker.on(heartbeat_of({6, 1}, mavlink::autopilot_ardupilot), 14580, begin + second));
      THEN("the first one counts") {
        CHECK(tracker.kind(begin + second) == mavlink::autopilot_px4);
      }
    }
    WHEN("another port sends as the same system") {
      const auto same = heartbeat_of({5, 1}, mavlink::autopilot_px4);
      THEN("that is not this autopilot, until the first port is silent for more than 5 s") {
        CHECK_FALSE(tracker.on(same, 40000, begin + second));
        CHECK_FALSE(tracker.has_sent(same, 40000));
        CHECK(tracker.has_sent(same, 14580));
        CHECK(tracker.on(same, 40000, begin + 6 * second));
        CHECK(tracker.has_sent(same, 40000));
      }
    }
    WHEN("it is silent for more than 5 s") {
      const SteadyTime later = begin + 6 * second;
      THEN("it is lost, and another one takes its place") {
        CHECK_FALSE(tracker.kind(later));
        tracker.on(heartbeat_of({6, 1}, mavlink::autopilot_ardupilot), 14580, later);
        CHECK(tracker.kind(later) == mavlink::autopilot_ardupilot);
        CHECK(tracker.own().system == 6);
      }
    }
  }
}

}  // namespace heartbeat_tracker_test
