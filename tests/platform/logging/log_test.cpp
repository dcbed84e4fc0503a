/// Lines reach standard error in order, no thread waits for a slow reader, and dropped lines are counted.

#include "logging/log.hpp"

#include "logging/captured_log.hpp"
#include "logging/later.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <csignal>
#include <fcntl.h>
#include <memory>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace log_test {

using namespace sonopose;
using logging::test::CapturedError;
using logging::test::Collector;
using test::wait_until;

constexpr auto unlimited = logging::Session::Repetition::unlimited;

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
  auto session = std::make_unique<logging::Session>(logging::Level::info, capacity, unlimited);
  for (std::size_t i = 0; i < lines; ++i) logging::info(fmt::format("line {}", i));
  REQUIRE(wait_until([&] { return session->dropped() >= lines - capacity - 1; }));  // one is being written
  const std::size_t dropped = session->dropped();
  CHECK(dropped <= lines - capacity);
  WHEN("it reads again") {
    std::string text = error.read(1);  // what filled the pipe; the rest fits into it
    session.reset();
    error.restore();
    text += error.read();
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
    const logging::Session session(logging::Level::info, logging::Session::default_capacity, unlimited);
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

SCENARIO("lines that repeat without end are counted, at the latest at the end of the session") {
  CapturedError error;
  logging::set_program("sonopose-x");
  constexpr int lines = 100;
  {
    const logging::Session session(logging::Level::info);
    for (int i = 0; i < lines; ++i) {
      logging::warning(fmt::format("a stranger sent {}", i));
      logging::later([i] { logging::info(fmt::format("a stranger has left {}", i)); });
    }
  }
  error.restore();
  const std::string text = error.read();
  CHECK_THAT(text, Catch::Contains("warning: a stranger sent 0\n") && !Catch::Contains("sent 60\n"));
  CHECK_THAT(text, Catch::Contains("sent 99 (39 more lines like this were not logged)\n"));
  CHECK_THAT(text, Catch::Contains("left 59\n") && !Catch::Contains("left 60\n"));
}

SCENARIO("a line that a listener causes reaches standard error, but no listener") {
  struct Logging final : logging::Listener {
    void on(const logging::Line& line) noexcept override {
      texts.emplace_back(line.text);
      logging::warning("a message of DDS");
    }
    std::vector<std::string> texts;
  };
  CapturedError error;
  logging::set_program("sonopose-x");
  Logging listener;
  {
    const logging::Session session(logging::Level::info);
    const logging::Listening listening(listener);
    logging::failure("one");
  }
  error.restore();
  CHECK(error.read() == "sonopose-x: warning: a message of DDS\nsonopose-x: one\n");
  CHECK(listener.texts == std::vector<std::string>{"one"});
}

}  // namespace log_test
