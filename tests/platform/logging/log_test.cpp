/// Lines reach standard error in order, no thread waits for a slow reader, and dropped lines are counted.

#include "logging/log.hpp"

#include "logging/later.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fcntl.h>
#include <future>
#include <memory>
#include <string>
#include <sys/ioctl.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace log_test {

using namespace sonopose;
using test::wait_until;

/// Standard error of this process as a pipe.
class CapturedError {
public:
  CapturedError() {
    int ends[2] = {-1, -1};
    REQUIRE(::pipe(ends) == 0);
    before_ = ::dup(STDERR_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[1]);
    read_end_ = ends[0];
  }
  CapturedError(const CapturedError&) = delete;
  CapturedError& operator=(const CapturedError&) = delete;
  ~CapturedError() {
    restore();
    close_reader();
  }

  /// Simulates a reader that goes away.
  void close_reader() {
    if (read_end_ >= 0) ::close(read_end_);
    read_end_ = -1;
  }

  /// Restores standard error; afterwards read() ends.
  void restore() {
    if (before_ < 0) return;
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    before_ = -1;
  }

  /// Writes until the pipe is full; returns the number of bytes.
  static std::size_t fill() {
    ::fcntl(STDERR_FILENO, F_SETPIPE_SZ, 4096);
    const int flags = ::fcntl(STDERR_FILENO, F_GETFL);
    ::fcntl(STDERR_FILENO, F_SETFL, flags | O_NONBLOCK);
    std::size_t written = 0;
    while (::write(STDERR_FILENO, "x", 1) == 1) ++written;
    ::fcntl(STDERR_FILENO, F_SETFL, flags);
    return written;
  }

  /// Bytes written but not yet read.
  [[nodiscard]] int waiting() const {
    int bytes = 0;
    ::ioctl(read_end_, FIONREAD, &bytes);
    return bytes;
  }

  /// Reads at least `size` bytes, or everything until no writer is left.
  std::string read(std::size_t size = SIZE_MAX) const {
    std::string text;
    char buffer[4096];
    while (text.size() < size) {
      const ssize_t got = ::read(read_end_, buffer, sizeof buffer);
      if (got <= 0) break;
      text.append(buffer, static_cast<std::size_t>(got));
    }
    return text;
  }

private:
  int before_ = -1;
  int read_end_ = -1;
};

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

SCENARIO("the end of a session writes all lines in their order, without those below its level") {
  CapturedError error;
  logging::set_program("sonopose-x");
  {
    const logging::Session session(logging::Level::info);
    logging::info("one");
    logging::debug("hidden");
    logging::warning("two");
    logging::error("three");
  }
  logging::info("four");  // immediately, without a session
  error.restore();
  CHECK(error.read() ==
        "sonopose-x: one\nsonopose-x: warning: two\nsonopose-x: error: three\nsonopose-x: four\n");
}

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

SCENARIO("the reason of an end is written after the lines that wait, at once") {
  CapturedError error;
  const std::string expected = "sonopose-x: formed later\nsonopose-x: one\nsonopose-x: the device is gone\n";
  const logging::Session session(logging::Level::error);
  logging::set_program("sonopose-x");
  logging::later([] { logging::write(logging::Level::failure, "formed later"); });
  logging::write(logging::Level::failure, "one");
  logging::failure("the device is gone");
  CHECK(error.read(expected.size()) == expected);  // even before the session ends
}

SCENARIO("a reader of the log that goes away does not end the process") {
  CapturedError error;
  struct sigaction before {};
  struct sigaction fatal {};
  fatal.sa_handler = SIG_DFL;
  ::sigaction(SIGPIPE, &fatal, &before);
  error.close_reader();
  logging::warning("without a session");
  {
    const logging::Session session(logging::Level::info);
    logging::warning("with a session");
    logging::failure("the last line");
  }
  THEN("and other writes to a closed pipe still do") {
    sigset_t pending;
    ::sigpending(&pending);
    CHECK(::sigismember(&pending, SIGPIPE) == 0);
    sigset_t blocked;
    ::pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    CHECK(::sigismember(&blocked, SIGPIPE) == 0);
  }
  ::sigaction(SIGPIPE, &before, nullptr);
}

SCENARIO("no thread waits for a reader that has stopped, and the dropped lines are counted and reported") {
  CapturedError error;
  logging::set_program("sonopose-x");
  CapturedError::fill();
  constexpr std::size_t lines = 100;
  constexpr std::size_t capacity = 8;
  auto session = std::make_unique<logging::Session>(logging::Level::info, capacity);
  for (std::size_t i = 0; i < lines; ++i) logging::info(fmt::format("line {}", i));
  REQUIRE(wait_until([&] { return session->dropped() >= lines - capacity - 1; }));  // one is being written
  const std::size_t dropped = session->dropped();
  CHECK(dropped <= lines - capacity);
  WHEN("it reads again") {
    std::string text;
    std::thread reader([&] { text = error.read(); });
    session.reset();
    error.restore();
    reader.join();
    THEN("the newest lines arrive, and how many are missing") {
      CHECK(text.find("line 99\n") != std::string::npos);
      CHECK(text.find("line 50\n") == std::string::npos);
      std::size_t reported = 0;
      const std::string before = "sonopose-x: warning: ";
      for (std::size_t at = text.find(before); at != std::string::npos; at = text.find(before, at + 1)) {
        reported += std::stoul(text.substr(at + before.size()));
      }
      CHECK(reported >= dropped);
      CHECK(reported >= dropped);
      CHECK(reported <= dropped + 1);  // the end of the session may displace one more
    }
  }
  WHEN("it never reads again") {
    session.reset();
    THEN("the process can end") {
      SUCCEED();
    }
  }
}

/// Stores the lines that it receives.
class Collector final : public logging::Listener {
public:
  void on(const logging::Line& line) noexcept override {
    texts.emplace_back(line.text);
    times_ns.push_back(line.time_ns);
    levels.push_back(line.level);
    thread = std::this_thread::get_id();
    ++count;
  }

  std::vector<std::string> texts;
  std::vector<std::int64_t> times_ns;
  std::vector<logging::Level> levels;
  std::thread::id thread;
  std::atomic<std::size_t> count = 0;  ///< readable while listening
};

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
  const logging::Session session(logging::Level::info);
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
  const logging::Session session(logging::Level::info);
  const logging::Listening listening(collector);
  constexpr std::size_t lines = 3000;  // more than may wait for standard error
  for (std::size_t i = 0; i < lines; ++i) {
    logging::info("at once");
    logging::later([] { logging::info("later"); });
    if (i % 100 == 99) REQUIRE(wait_until([&] { return collector.count == 2 * (i + 1); }));
  }
  CHECK(error.waiting() == static_cast<int>(filled));
}

SCENARIO("a terminal that shows nothing does not keep a process from its end") {
  const CapturedError error;  // restores standard error
  const test::PseudoTerminal terminal;
  const int line = ::open(terminal.device().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  REQUIRE(line >= 0);
  ::dup2(line, STDERR_FILENO);
  ::close(line);
  const int flags = ::fcntl(STDERR_FILENO, F_GETFL);
  Collector collector;
  {
    const logging::Session session(logging::Level::info);
    const logging::Listening listening(collector);
    constexpr std::size_t lines = 500;  // more than the terminal buffers
    for (std::size_t i = 0; i < lines; ++i) logging::info(std::string(1000, 'y'));
    CHECK(wait_until([&] { return collector.count == lines; }));
  }
  CHECK(::fcntl(STDERR_FILENO, F_GETFL) == flags);  // other processes share the flags
}

SCENARIO("a line longer than a pipe is written as it is read") {
  CapturedError error;
  logging::set_program("sonopose-x");
  ::fcntl(STDERR_FILENO, F_SETPIPE_SZ, 4096);
  const std::string text(100'000, 'z');
  std::string received;
  std::thread reader([&] { received = error.read(); });
  {
    const logging::Session session(logging::Level::info);
    logging::info(text);
  }
  logging::info(text);  // without a session
  error.restore();
  reader.join();
  CHECK((received == "sonopose-x: " + text + "\nsonopose-x: " + text + "\n"));
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

SCENARIO("a listener comes and goes while standard error takes nothing") {
  CapturedError error;
  CapturedError::fill();
  const logging::Session session(logging::Level::info);
  for (int i = 0; i < 3; ++i) logging::info("waits");
  Collector collector;
  { const logging::Listening listening(collector); }  // does not wait for standard error
  CHECK(collector.texts.size() <= 3);                 // those not yet taken
}

}  // namespace log_test
