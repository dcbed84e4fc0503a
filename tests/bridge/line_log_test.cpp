#include "bridge/line_log.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace line_log_test {

using namespace sonopose;
using logging::Level;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("a device that comes and goes does not fill the log") {
  std::vector<std::string> lines;
  bridge::LineLog log([&](Level, const std::string& text) { lines.push_back(text); });
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
    CHECK(lines.back() == "reading a (92 changes were not logged)");
    log.update(begin + 62 * second_ns);
    log.finish();
    CHECK(lines.size() == 9);
  }
  THEN("or when the line ends") {
    log.finish();
    CHECK(lines.back() == "reading a (92 changes were not logged)");
  }
}

}  // namespace line_log_test
