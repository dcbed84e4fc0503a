/// State changes in words, each logged once, and a flapping state limited.

#include "transitions/transition_log.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace transition_log_test {

using namespace sonopose;
using namespace sonopose::transitions;
using logging::Level;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("a change is logged with its beacon, its reason and its level") {
  struct Case {
    Transition transition;
    LogText line;
  };
  const auto [transition, line] = GENERATE(
      Case{{.address = 7, .kind = Kind::found}, {Level::info, "beacon 7: found"}},
      Case{{.address = 7, .kind = Kind::initialised, .lasted_s = 1.25},
           {Level::info, "beacon 7: initialised, after 1.2 s"}},
      Case{{.address = 7, .kind = Kind::stale, .value = 1.0},
           {Level::warning, "beacon 7: stale: no valid fix for 1.0 s"}},
      Case{{.address = 7, .kind = Kind::stale, .begins = false, .lasted_s = 4.2},
           {Level::info, "beacon 7: no longer stale, after 4.2 s"}},
      Case{{.address = 9, .kind = Kind::gated, .value = 2.31, .count = 10},
           {Level::warning, "beacon 9: gated: 10 fixes in a row are outliers, the latest by 2.31 m"}},
      Case{{.address = 9, .kind = Kind::bridge_lost},
           {Level::error, "beacon 9: bridge lost: it crashed, was killed, or cannot be reached"}},
      Case{{.address = all_beacons, .kind = Kind::overloaded, .begins = false},
           {Level::info, "no longer overloaded: every pose is written"}});
  CHECK(line_of(transition) == line);
}

SCENARIO("every kind has words for its beginning and its end") {
  for (std::size_t i = 0; i < kind_count; ++i) {
    for (const bool begins : {true, false}) {
      const LogText line = line_of({.address = 7, .kind = static_cast<Kind>(i), .begins = begins});
      CAPTURE(i, begins);
      CHECK(line.text.size() > std::string("beacon 7: ").size());
    }
  }
}

SCENARIO("what a flapping state did last is logged when its beacon or the process ends") {
  std::vector<LogText> lines;
  TransitionLog log([&](const LogText& line) { lines.push_back(line); });
  const SteadyTime begin{100 * second_ns};
  for (const BeaconAddress address : {BeaconAddress{7}, BeaconAddress{8}}) {
    for (int i = 0; i < 10; ++i) {
      log.on({.address = address, .kind = Kind::stale, .begins = i % 2 == 0, .lasted_s = 0.1}, begin);
    }
  }
  REQUIRE(lines.size() == 8);
  log.forget(7);
  REQUIRE(lines.size() == 9);
  CHECK(lines.back().text == "beacon 7: no longer stale, after 0.1 s (5 earlier changes were not logged)");
  log.finish();
  REQUIRE(lines.size() == 10);
  CHECK(lines.back().text == "beacon 8: no longer stale, after 0.1 s (5 earlier changes were not logged)");
  log.finish();
  CHECK(lines.size() == 10);
}

SCENARIO("a flapping state does not flood the log, and its last state is logged") {
  std::vector<LogText> lines;
  TransitionLog log([&](const LogText& line) { lines.push_back(line); });
  const SteadyTime begin{100 * second_ns};
  const auto flap = [&](BeaconAddress address, int changes) {
    for (int i = 0; i < changes; ++i) {
      log.on({.address = address, .kind = Kind::stale, .begins = i % 2 == 0, .lasted_s = 0.1},
             begin + i * second_ns / 10);
    }
  };
  flap(7, 101);
  REQUIRE(lines.size() == 4);
  log.on({.address = 7, .kind = Kind::frozen}, begin);  // another kind
  flap(8, 2);                                           // another beacon
  CHECK(lines.size() == 7);
  log.update(begin + 59 * second_ns);
  CHECK(lines.size() == 7);
  log.update(begin + 61 * second_ns);
  REQUIRE(lines.size() == 8);
  CHECK(lines.back().level == Level::warning);
  CHECK(lines.back().text == "beacon 7: stale: no valid fix for 0.0 s (96 earlier changes were not logged)");
  log.update(begin + 200 * second_ns);
  CHECK(lines.size() == 8);
  log.on({.address = 7, .kind = Kind::stale, .begins = false}, begin + 300 * second_ns);
  CHECK(lines.size() == 9);
}

SCENARIO("a change that is logged late counts as logged") {
  std::vector<LogText> lines;
  TransitionLog log([&](const LogText& line) { lines.push_back(line); });
  for (int i = 0; i < 5; ++i) {
    log.on({.address = 7, .kind = Kind::stale, .begins = i % 2 == 0, .lasted_s = 0.1}, SteadyTime{second_ns});
  }
  log.finish();
  REQUIRE(lines.size() == 5);
  CHECK(lines.back().text == "beacon 7: stale: no valid fix for 0.0 s");
}

SCENARIO("changes that were dropped before they were logged are reported") {
  std::vector<LogText> lines;
  TransitionLog log([&](const LogText& line) { lines.push_back(line); });
  TransitionQueue pending;
  for (int i = 0; i < 40; ++i) {
    pending.add({.address = static_cast<BeaconAddress>(i), .kind = Kind::found});
  }
  const std::size_t kept = pending.values().size();
  log.take(pending, SteadyTime{});
  log.update(SteadyTime{});
  REQUIRE(lines.size() == kept + 1);
  CHECK(lines.back().text ==
        std::to_string(40 - kept) + " changes of state were not logged: too many at a time");
  log.update(SteadyTime{});
  CHECK(lines.size() == kept + 1);
}

}  // namespace transition_log_test
