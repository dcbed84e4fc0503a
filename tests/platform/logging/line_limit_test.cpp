/// Lines of one kind are limited per minute, and those left out are counted.

#include "logging/line_limit.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <chrono>
#include <string>
#include <vector>

namespace line_limit_test {

using namespace sonopose::logging;
using namespace std::chrono_literals;

/// A limit with a clock.
struct Rig {
  std::vector<std::string> log(const std::string& text, Level level = Level::warning) {
    std::vector<std::string> texts;
    for (const auto& line : limit.admitted(level, text, now)) texts.push_back(line.text);
    return texts;
  }

  /// Number of lines that come out of `count` lines, as many as in a second.
  std::size_t flood(std::size_t count, Level level = Level::warning) {
    std::size_t admitted = 0;
    for (std::size_t i = 0; i < count; ++i) admitted += log(fmt::format("refused {}", next++), level).size();
    now += 1s;
    return admitted;
  }

  LineLimit limit;
  LineLimit::Time now{1h};
  std::size_t next = 0;
};

SCENARIO("the kind of a line has no numbers, times and identifiers") {
  CHECK(kind_of("beacon 7: stale: no valid fix for 1.0 s") == "beacon #: stale: no valid fix for #.# s");
  CHECK(kind_of("data(application, vendor 1.16): 110a5c3:9bf:1:702 #5: failed") ==
        "data(application, vendor #.#): #:#:#:# ##: failed");
  CHECK(kind_of("Größe_x\n") == "Größe_x\n");
  CHECK(kind_of("").empty());
  CHECK(kind_of(std::string(5000, 'x')).size() == 128);
}

SCENARIO("a flood of one kind is a minute's lines, and then one a minute with the count") {
  Rig rig;
  CHECK(rig.flood(100) == LineLimit::max_of_kind);
  for (int i = 1; i < 60; ++i) CHECK(rig.flood(100) == 0);
  THEN("the latest is reported with the number of the others") {
    CHECK(rig.log("other") ==
          std::vector<std::string>{"refused 5999 (5939 more lines like this were not logged)", "other"});
    CHECK(rig.limit.due(rig.now).empty());
    for (int minute = 0; minute < 5; ++minute) {
      std::size_t admitted = 0;
      for (int i = 0; i < 60; ++i) admitted += rig.flood(100);
      CHECK(admitted <= 1);
    }
    AND_WHEN("it pauses for a minute") {
      rig.now += 2 * LineLimit::window;
      THEN("lines are logged again") {
        CHECK(rig.log("refused again").size() == 2);
        CHECK(rig.flood(3) == 3);
      }
    }
  }
  THEN("it is reported without another line") {
    const auto lines = rig.limit.due(rig.now);
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].text == "refused 5999 (5939 more lines like this were not logged)");
    CHECK(rig.limit.due(rig.now).empty());
    CHECK(rig.limit.finish().empty());
  }
  THEN("its end is reported") {
    const auto lines = rig.limit.finish();
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].level == Level::warning);
    CHECK(lines[0].text == "refused 5999 (5939 more lines like this were not logged)");
    CHECK(rig.limit.finish().empty());
  }
  THEN("lines of another kind are logged") {
    CHECK(rig.log("beacon 7: stale").back() == "beacon 7: stale");
  }
  THEN("the reason of an end, and lines for a developer, are logged") {
    CHECK(rig.flood(1, Level::failure) >= 1);
    CHECK(rig.flood(200, Level::debug) >= 200);
  }
}

SCENARIO("one line left out is logged as it is") {
  Rig rig;
  CHECK(rig.flood(61) == 60);
  rig.now += LineLimit::window;
  CHECK(rig.log("other") == std::vector<std::string>{"refused 60", "other"});
}

SCENARIO("lines of many beacons are no flood") {
  Rig rig;
  for (int beacon = 0; beacon < 256; ++beacon) {
    CHECK(rig.log(fmt::format("beacon {}: found", beacon)).size() == 1);
    CHECK(rig.log(fmt::format("beacon {}: initialised", beacon)).size() == 1);
  }
}

/// A word without digits for a number.
std::string word_of(std::size_t number) {
  std::string word;
  for (; number > 0; number /= 26) word += static_cast<char>('a' + number % 26);
  return word + "_";
}

SCENARIO("a flood of ever new kinds is bounded too") {
  Rig rig;
  std::size_t admitted = 0;
  constexpr std::size_t lines = 20'000;
  for (std::size_t i = 0; i < lines; ++i) admitted += rig.log("name " + word_of(i)).size();
  CHECK(admitted <= LineLimit::max_kinds + LineLimit::max_of_kind);
  CHECK(admitted >= LineLimit::max_kinds);
  WHEN("each kind repeats") {
    for (std::size_t i = 0; i < lines; ++i) admitted += rig.log("name " + word_of(i % 200)).size();
    THEN("all together are limited, and counted") {
      CHECK(admitted == LineLimit::max_of_all);
      rig.now += LineLimit::window;
      const auto reports = rig.log("other");
      CHECK(reports.back() == "other");
      CHECK(reports.at(reports.size() - 2).find("lines were not logged: more than 1000 in a minute") !=
            std::string::npos);
    }
  }
}

}  // namespace line_limit_test
