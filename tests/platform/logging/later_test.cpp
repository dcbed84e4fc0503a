/// Lines that are logged later: formed on the thread of the log, in order with the others.

#include "logging/later.hpp"

#include "logging/captured_log.hpp"
#include "logging/log.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <future>
#include <string>
#include <thread>
#include <vector>

namespace later_test {

using namespace sonopose;
using logging::test::CapturedError;
using logging::test::Collector;
using test::wait_until;

/// Blocks the log's thread.
class OccupiedThread {
public:
  OccupiedThread() {
    logging::later([this, released = released_.get_future().share()] {
      begun_.set_value();
      released.wait();
    });
    begun_.get_future().wait();
  }

  void release() { released_.set_value(); }

private:
  std::promise<void> begun_;
  std::promise<void> released_;
};

SCENARIO("a line that is logged later is formed on the thread of the log") {
  CapturedError error;
  logging::set_program("sonopose-x");
  std::vector<std::thread::id> threads;
  const auto log = [&threads](const std::string& line) {
    logging::later([&threads, line] {
      threads.push_back(std::this_thread::get_id());
      logging::info("later " + line);
    });
  };
  WHEN("there is a session") {
    {
      const logging::Session session(logging::Level::info);
      log("one");
      log("two");
    }
    error.restore();
    THEN("its end writes all of them in their order, and the caller has formed none") {
      CHECK(error.read() == "sonopose-x: later one\nsonopose-x: later two\n");
      REQUIRE(threads.size() == 2);
      CHECK(threads[0] != std::this_thread::get_id());
      CHECK(threads[1] == threads[0]);
    }
  }
  WHEN("there is none") {
    log("one");
    error.restore();
    THEN("it is formed at once") {
      CHECK(error.read() == "sonopose-x: later one\n");
      CHECK(threads == std::vector{std::this_thread::get_id()});
    }
  }
  WHEN("2092 are logged while that thread is busy") {
    {
      const logging::Session session(logging::Level::info,
                                     4096);  // bound of the lines that may wait for standard error
      OccupiedThread thread;
      for (int i = 0; i < 2092; ++i) log(std::to_string(i));
      thread.release();
    }
    error.restore();
    THEN("2048 wait, and the others are counted") {
      CHECK(threads.size() == 2048);
      const std::string text = error.read();
      CHECK_THAT(text, Catch::Contains("sonopose-x: warning: 44 changes were not logged"));
      CHECK_THAT(text, !Catch::Contains("lines of this log"));
    }
  }
}

SCENARIO("lines that are logged at once and later keep their order, with their times") {
  CapturedError error;
  Collector collector;
  const logging::Session session(logging::Level::info);
  const logging::Listening listening(collector);
  OccupiedThread thread;
  const auto now_ns = [] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  logging::info("one");
  const std::int64_t before_two_ns = now_ns();
  logging::later([] { logging::info("two"); });
  const std::int64_t after_two_ns = now_ns();
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  logging::info("three");
  logging::later([] {
    logging::info("four");
    logging::info("five");
  });
  logging::info("six");
  thread.release();
  logging::failure("seven");
  REQUIRE(wait_until([&] { return collector.count == 7; }));
  CHECK(collector.texts == std::vector<std::string>{"one", "two", "three", "four", "five", "six", "seven"});
  CHECK(std::is_sorted(collector.times_ns.begin(), collector.times_ns.end()));
  REQUIRE(collector.times_ns.size() == 7);
  CHECK(collector.times_ns[1] >= before_two_ns);
  CHECK(collector.times_ns[1] <= after_two_ns);
}

}  // namespace later_test
