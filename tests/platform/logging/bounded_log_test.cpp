#include "logging/bounded_log.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace bounded_log_test {

using namespace sonopose;
using logging::Level;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("a device that comes and goes does not fill the log") {
  std::vector<std::string> lines;
  logging::BoundedLog log(8, [&](Level, const std::string& text) { lines.push_back(text); });
  const SteadyTime begin{100 * second_ns};
  for (int i = 0; i < 100; ++i) {
    log.write(Level::warning, i % 2 == 0 ? "waiting for a" : "reading a", begin + i * second_ns / 4);
  }
  CHECK(lines.size() == 8);
  log.update(begin + 59 * second_ns);
  CHECK(lines.size() == 8);
  THEN("its latest state is logged when the minute is over") {
    log.update(begin + 61 * second_ns);
    REQUIRE(lines.size() == 9);
    CHECK(lines.back() == "reading a (91 lines were not logged)");
    log.update(begin + 62 * second_ns);
    log.finish();
    CHECK(lines.size() == 9);
  }
  THEN("or when the line ends") {
    log.finish();
    CHECK(lines.back() == "reading a (91 lines were not logged)");
  }
  THEN("or before the next line after the minute") {
    log.write(Level::info, "reading b", begin + 61 * second_ns);
    REQUIRE(lines.size() == 10);
    CHECK(lines[8] == "reading a (91 lines were not logged)");
    CHECK(lines[9] == "reading b");
  }
}

SCENARIO("a single line that was delayed is complete, and one that was left out is singular") {
  std::string last;
  logging::BoundedLog log(1, [&](Level, const std::string& text) { last = text; });
  const SteadyTime now{100 * second_ns};
  log.write(Level::info, "a", now);
  log.write(Level::info, "b", now);
  CHECK(log.has_pending());
  log.finish();
  CHECK(last == "b");
  log.write(Level::info, "c", now);
  log.write(Level::info, "d", now);
  log.finish();
  CHECK(last == "d (1 line was not logged)");
  CHECK_FALSE(log.has_pending());
}

}  // namespace bounded_log_test
