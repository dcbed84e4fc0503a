/// Settings at each event.

#include "fusion/settings_timeline.hpp"

#include <catch2/catch.hpp>

namespace settings_timeline_test {

using namespace sonopose;
using fusion::SettingsTimeline;
using Scope = SettingsTimeline::Scope;

config::Assignments sigma(double value_m) {
  return {{"documented.trust.sigma_m", value_m}};
}

/// The tested setting at the current event.
double sigma_m(const SettingsTimeline& timeline) {
  return timeline.settings().trust.sigma_m;
}

constexpr double at_start_m = settings::TrustSettings{}.sigma_m;

SCENARIO("a change applies from its event on") {
  GIVEN("a change from event 100 on") {
    SettingsTimeline timeline{config::BeaconSettings{}};
    timeline.add(100, Scope::own, sigma(0.5));
    WHEN("the events before it come") {
      CHECK_FALSE(timeline.advance(1));
      CHECK_FALSE(timeline.advance(99));
      THEN("nothing has changed, and what will is known") {
        CHECK(sigma_m(timeline) == at_start_m);
        CHECK(timeline.settings_at(99).trust.sigma_m == at_start_m);
        CHECK(timeline.settings_at(100).trust.sigma_m == 0.5);
      }
    }
    WHEN("its event comes") {
      THEN("it applies, and is reported once") {
        CHECK(timeline.advance(100));
        CHECK(sigma_m(timeline) == 0.5);
        CHECK_FALSE(timeline.advance(101));
        CHECK(sigma_m(timeline) == 0.5);
      }
    }
    WHEN("its event was lost, and the next one comes") {
      THEN("it applies from that one") {
        CHECK(timeline.advance(103));
        CHECK(sigma_m(timeline) == 0.5);
      }
    }
    WHEN("the numbering restarts before it") {
      timeline.advance(90);
      THEN("it waits for its number") {
        CHECK_FALSE(timeline.advance(1));
        CHECK(timeline.advance(100));
      }
    }
  }
  GIVEN("a change from the next event on") {
    SettingsTimeline timeline{config::BeaconSettings{}};
    timeline.advance(1000);
    timeline.add(0, Scope::own, sigma(0.5));
    THEN("it applies at the next one, even if the numbering restarts") {
      CHECK(sigma_m(timeline) == at_start_m);
      CHECK(timeline.advance(1));
      CHECK(sigma_m(timeline) == 0.5);
    }
  }
}

SCENARIO("several changes apply in the order of their numbers, not of the requests") {
  GIVEN("a change from 200 on, and then one from 100 on") {
    SettingsTimeline timeline{config::BeaconSettings{}};
    timeline.add(200, Scope::own, sigma(0.2));
    timeline.add(100, Scope::own, {{"documented.trust.sigma_m", 0.1}, {"documented.trust.n_base", 9}});
    THEN("each applies from its own event on, on top of the earlier ones") {
      CHECK(timeline.advance(100));
      CHECK(sigma_m(timeline) == 0.1);
      CHECK(timeline.advance(200));
      CHECK(sigma_m(timeline) == 0.2);
      CHECK(timeline.settings().trust.n_base == 9);
    }
    THEN("one event can reach both") {
      CHECK(timeline.advance(250));
      CHECK(sigma_m(timeline) == 0.2);
      CHECK_FALSE(timeline.advance(251));
    }
    WHEN("one is asked for again with the same number") {
      timeline.add(100, Scope::own, sigma(0.15));
      THEN("the last one counts") {
        timeline.advance(100);
        CHECK(sigma_m(timeline) == 0.15);
        CHECK(timeline.settings().trust.n_base == 9);
      }
    }
    WHEN("another is added between them when the first applies already") {
      timeline.advance(100);
      timeline.add(150, Scope::own, sigma(0.15));
      THEN("the three follow each other") {
        CHECK(sigma_m(timeline) == 0.1);
        CHECK(timeline.advance(150));
        CHECK(sigma_m(timeline) == 0.15);
        CHECK(timeline.advance(200));
        CHECK(sigma_m(timeline) == 0.2);
      }
    }
  }
  GIVEN("a change for all from 100 on, and one of the beacon's own from 200 on") {
    SettingsTimeline timeline{config::BeaconSettings{}};
    timeline.add(200, Scope::own, sigma(0.2));
    timeline.add(100, Scope::for_all, sigma(0.1));
    timeline.add(300, Scope::for_all, sigma(0.3));
    THEN("the change for all applies until the beacon has its own") {
      timeline.advance(100);
      CHECK(sigma_m(timeline) == 0.1);
      timeline.advance(200);
      CHECK(sigma_m(timeline) == 0.2);
      timeline.advance(300);
      CHECK(sigma_m(timeline) == 0.2);
    }
  }
  GIVEN("both for the same event") {
    SettingsTimeline timeline{config::BeaconSettings{}};
    timeline.add(100, Scope::own, sigma(0.2));
    timeline.add(100, Scope::for_all, sigma(0.1));
    THEN("the beacon's own applies") {
      timeline.advance(100);
      CHECK(sigma_m(timeline) == 0.2);
    }
  }
}

SCENARIO("the number of waiting changes is limited") {
  GIVEN("as many as the capacity") {
    SettingsTimeline timeline{config::BeaconSettings{}};
    for (std::uint64_t i = 1; i <= SettingsTimeline::capacity; ++i) {
      REQUIRE(timeline.can_add(100 * i));
      timeline.add(100 * i, Scope::own, sigma(0.01 * static_cast<double>(i)));
    }
    THEN("there is none for another number, but for the same ones") {
      CHECK_FALSE(timeline.can_add(50));
      CHECK(timeline.can_add(100));
    }
    THEN("there is again when one applies") {
      timeline.advance(100);
      CHECK(timeline.can_add(150));
    }
    THEN("one more makes the lowest number apply at once, and the others as before") {
      timeline.add(150, Scope::own, {{"documented.trust.n_base", 9}});
      CHECK(sigma_m(timeline) == 0.01);
      timeline.advance(200);
      CHECK(sigma_m(timeline) == 0.02);
      CHECK(timeline.settings().trust.n_base == 9);
      CHECK(timeline.can_add(1));
    }
  }
}

}  // namespace settings_timeline_test
