#include "transitions/line.hpp"

#include <catch2/catch.hpp>

#include <set>
#include <string>

namespace transition_line_test {

using namespace sonopose::transitions;

Transition transition_of(Kind kind, bool begins, double figure) {
  return {.address = 7,
          .kind = kind,
          .begins = begins,
          .lasted_s = figure,
          .value = 2.0 * figure,
          .count = static_cast<std::uint64_t>(figure)};
}

SCENARIO("a line names its change whatever the figures are") {
  std::set<std::string> changes;
  int count = 0;
  for (std::size_t i = 0; i < kind_count; ++i) {
    const Kind kind = static_cast<Kind>(i);
    if (kind == Kind::fixes_silent || kind == Kind::poses_silent) continue;  // "no fix for 0.3 s"
    const bool only_happens = kind == Kind::found || kind == Kind::initialised || kind == Kind::restarted ||
                              kind == Kind::relocated;
    for (const bool begins : {true, false}) {
      if (only_happens && !begins) continue;
      const std::string a = line_of(transition_of(kind, begins, 1.0)).text;
      const std::string b = line_of(transition_of(kind, begins, 23.4)).text;
      CAPTURE(a, b);
      CHECK(change_of(a) == change_of(b));
      CHECK(change_of(a + " (3 earlier changes were not logged)") == change_of(a));
      changes.emplace(change_of(a));
      ++count;
    }
  }
  THEN("and no two changes have the same name") {
    CHECK(changes.size() == static_cast<std::size_t>(count));
  }
}

SCENARIO("the name of a change has the beacon") {
  CHECK(change_of("beacon 7: stale: no valid fix for 1.0 s") == "beacon 7: stale");
  CHECK(change_of("beacon 17: no longer gated, after 1 fix") == "beacon 17: no longer gated");
  CHECK(change_of("overloaded: every sample is fused") == "overloaded");
  CHECK(change_of("a: b") == "a");
  CHECK(change_of("beacon 7") == "beacon 7");
  CHECK(change_of("").empty());
}

}  // namespace transition_line_test
