/// Rules of ownership: a beacon has one owner, beside which no fusion sends its backlog.

#include "faults/artificial_history.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

namespace history_owners_test {

using namespace sonopose;
using namespace sonopose::faults;
using namespace sonopose::faults::artificial;
using Catch::Contains;

SCENARIO("a beacon has one owner") {
  GIVEN("one pose of the weaker fusion between those of the stronger one") {
    History history = undisturbed();
    Arrival& pose = pose_after(history, 8);
    pose.process = pose.writer = process_of(pose.strength = 200);
    const auto violations = violations_of(history);
    THEN("a promise is broken") {
      REQUIRE(violations.size() == 1);
      CHECK_THAT(violations.front(), Contains("fusion-200 is received although fusion-300 owns"));
    }
  }
  GIVEN("a takeover after a kill") {
    THEN("the weaker one is received") {
      CHECK(violations_of(takeover(7.105)) == none);
    }
  }
  GIVEN("a takeover without a reason") {
    History history = takeover(7.105);
    history.losses.clear();
    history.episodes.pop_back();
    THEN("the weaker one must not be received, and nothing counts the samples between them") {
      CHECK(violations_of(history).size() == 2);
    }
  }
}

SCENARIO("a fusion that is stopped writes at most the pose that it has in hand when it continues") {
  for (const int old : {1, 2}) {
    History history = takeover(7.105);
    history.episodes.back() = {{.fault = Fault::stop, .target = Role::first_fusion}, {at(7), at(7.6)}};
    const auto next = std::find_if(history.poses.begin(), history.poses.end(),
                                   [](const Arrival& pose) { return pose.received >= at(7.6001); });
    std::vector<Arrival> in_hand;
    for (int i = 0; i < old; ++i) {
      in_hand.push_back(pose_at(at(6.995)));
      in_hand.back().received = at(7.6001) + i;
    }
    history.poses.insert(next, in_hand.begin(), in_hand.end());
    CHECK(violations_of(history).empty() == (old == 1));
  }
}

SCENARIO("late poses end no silence, and a fusion that continues sends one at most beside a warm one") {
  History history = undisturbed();
  const auto mark_late = [&history](double from_s, double until_s) {
    for (Arrival& pose : history.poses) {
      if (pose.received >= at(from_s) && pose.received < at(until_s)) pose.status = status_late;
    }
  };
  GIVEN("late poses for 0.3 s") {
    mark_late(7, 7.3);
    const Violations violations = violations_of(history);
    THEN("a promise is broken") {
      REQUIRE(violations.size() == 2);
      CHECK_THAT(violations[0] + violations[1],
                 Contains("late beside a warm fusion") && Contains("no pose for 300"));
    }
  }
  GIVEN("a single one") {
    mark_late(7, 7.004);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("some that a busy machine kept waiting") {
    mark_late(7, 7.05);
    THEN("they are no violation if it waited shortly before") {
      CHECK_THAT(violations_of(history).at(0), Contains("late beside a warm fusion"));
      history.stalls = {{at(6.9), at(6.98)}};
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("a step of the bridge's clock, after which all are late") {
    history.episodes.push_back({{.fault = Fault::clock_step, .target = Role::bridge}, {at(6.5), at(6.5)}});
    mark_late(7, 7.3);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
}

}  // namespace history_owners_test
