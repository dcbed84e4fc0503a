/// Changes derived by the page, unless a fusion logs them.

#include "web/held_events.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace held_events_test {

using sonopose::web::HeldEvents;
using Texts = std::vector<std::string>;

SCENARIO("a change is shown unless a fusion logs the same one") {
  HeldEvents held;
  held.hold("beacon 7: initialised, after 0.1 s", "a");
  held.hold("beacon 8: initialised, after 0.1 s", "b");
  GIVEN("a fusion that logs one of them, with a figure of its own") {
    const bool comes_first = GENERATE(true, false);
    HeldEvents events;
    if (comes_first) {
      events.on_logged("beacon 7: initialised, after 0.2 s");
      CHECK(events.take_due().empty());
    }
    events.hold("beacon 7: initialised, after 0.1 s", "a");
    events.hold("beacon 8: initialised, after 0.1 s", "b");
    CHECK(events.take_due().empty());
    if (!comes_first) events.on_logged("beacon 7: initialised, after 0.2 s");
    THEN("the other one is shown") {
      CHECK(events.take_due() == Texts{"b"});
    }
  }
  GIVEN("a fusion that logs something else") {
    held.on_logged("beacon 7: bridge lost: it crashed, was killed, or cannot be reached");
    held.on_logged("beacon 7: no longer stale, after 2.0 s");
    CHECK(held.take_due().empty());
    THEN("both are shown, once") {
      CHECK(held.take_due() == Texts{"a", "b"});
      CHECK(held.take_due().empty());
    }
  }
  GIVEN("a fusion that logged the same change long ago") {
    HeldEvents events;
    events.on_logged("beacon 7: stale: no valid fix for 1.0 s");
    for (int second = 0; second < 3; ++second) events.take_due();
    events.hold("beacon 7: stale: no valid fix for 1.0 s", "again");
    events.take_due();
    THEN("it is shown") {
      CHECK(events.take_due() == Texts{"again"});
    }
  }
}

SCENARIO("of too many changes the latest are kept, and the others counted") {
  HeldEvents held;
  for (std::size_t i = 0; i < HeldEvents::max_events + 3; ++i)
    held.hold("beacon 7: found", std::to_string(i));
  CHECK(held.take_dropped() == 3);
  CHECK(held.take_dropped() == 0);
  held.take_due();
  const Texts due = held.take_due();
  REQUIRE(due.size() == HeldEvents::max_events);
  CHECK(due.front() == "3");
}

SCENARIO("of too many logged changes the first are recognised") {
  HeldEvents held;
  held.on_logged("beacon 7: found");
  for (std::size_t i = 0; i < HeldEvents::max_logged; ++i) held.on_logged("line " + std::to_string(i));
  held.on_logged("beacon 8: found");
  held.hold("beacon 7: found", "known");
  held.hold("beacon 8: found", "not recognised");
  held.take_due();
  CHECK(held.take_due() == Texts{"not recognised"});
}

}  // namespace held_events_test
