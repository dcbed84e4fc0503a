/// Listeners of the log: which lines they receive, and that standard error does not keep them waiting.

#include "logging/captured_log.hpp"
#include "logging/later.hpp"
#include "logging/log.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace listeners_test {

using namespace sonopose;
using logging::test::CapturedError;
using logging::test::Collector;
using test::wait_until;

constexpr auto capacity = logging::Session::default_capacity;
constexpr auto unlimited = logging::Session::Repetition::unlimited;

SCENARIO("a listener receives the lines of a session, on the thread of the log") {
  CapturedError error;
  logging::set_program("sonopose-x");
  CHECK(logging::program() == "sonopose-x");
  Collector collector;
  {
    const logging::Session session(logging::Level::info);
    logging::info("before it listened");
    const logging::Listening listening(collector);
    logging::debug("below the level of the session");
    logging::warning("with it");
    logging::failure("the last line");  // returns after all lines are written
    THEN("it has them all, with levels and times") {
      CHECK(collector.texts == std::vector<std::string>{"before it listened", "with it", "the last line"});
      CHECK(collector.levels ==
            std::vector{logging::Level::info, logging::Level::warning, logging::Level::failure});
      CHECK(collector.thread != std::this_thread::get_id());
      const std::string on_error =
          "sonopose-x: before it listened\nsonopose-x: warning: with it\nsonopose-x: the last line\n";
      CHECK(error.waiting() == static_cast<int>(on_error.size()));
      REQUIRE(std::is_sorted(collector.times_ns.begin(), collector.times_ns.end()));
      constexpr std::int64_t year_2020_ns = 1'577'836'800'000'000'000;
      CHECK(collector.times_ns.front() > year_2020_ns);
    }
  }
  logging::info("without a session");
  CHECK(collector.texts.size() == 3);
}

SCENARIO("a listener receives the latest of the earlier lines only, and none after its end") {
  CapturedError error;
  const logging::Session session(logging::Level::info, capacity, unlimited);
  for (int i = 0; i < 100; ++i) logging::info(fmt::format("line {}", i));
  logging::failure("line 100");  // returns after all are written
  Collector collector;
  Collector other;
  const logging::Listening for_all(other);
  {
    const logging::Listening listening(collector);
    logging::failure("news");
  }
  logging::failure("after its end");
  REQUIRE(collector.texts.size() == logging::Listening::max_earlier + 1);
  CHECK(collector.texts.front() == "line 37");
  CHECK(collector.texts.back() == "news");
  CHECK(other.texts.back() == "after its end");
}

SCENARIO("listeners receive lines while standard error takes nothing") {
  CapturedError error;
  const std::size_t filled = CapturedError::fill();
  Collector collector;
  const logging::Session session(logging::Level::info, capacity, unlimited);
  const logging::Listening listening(collector);
  constexpr std::size_t lines = 3000;  // more than may wait for standard error
  for (std::size_t i = 0; i < lines; ++i) {
    logging::info("at once");
    logging::later([] { logging::info("later"); });
    if (i % 100 == 99) REQUIRE(wait_until([&] { return collector.count == 2 * (i + 1); }));
  }
  CHECK(error.waiting() == static_cast<int>(filled));
}

SCENARIO("a listener comes and goes while standard error takes nothing") {
  CapturedError error;
  CapturedError::fill();
  const logging::Session session(logging::Level::info);
  for (int i = 0; i < 3; ++i) logging::info("waits");
  Collector collector;
  { const logging::Listening listening(collector); }  // does not wait for standard error
  CHECK(collector.texts.size() <= 3);                 // those not yet taken
}

}  // namespace listeners_test
