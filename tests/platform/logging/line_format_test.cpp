/// Format of a log line, and recognition of the journal.

#include "logging/line_format.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace line_format_test {

using namespace sonopose::logging;

SCENARIO("a line names its level as a word on a terminal, and as a priority in the journal") {
  struct Case {
    Level level;
    std::string text;
    std::string journal;
  };
  // Priorities of syslog(3).
  const auto [level, text, journal] = GENERATE(Case{Level::debug, "sonopose-x: y\n", "<7>y\n"},
                                               Case{Level::info, "sonopose-x: y\n", "<6>y\n"},
                                               Case{Level::warning, "sonopose-x: warning: y\n", "<4>y\n"},
                                               Case{Level::error, "sonopose-x: error: y\n", "<3>y\n"},
                                               Case{Level::failure, "sonopose-x: y\n", "<3>y\n"});
  CHECK(formatted(Stream::text, "sonopose-x", level, "y") == text);
  CHECK(formatted(Stream::journal, "sonopose-x", level, "y") == journal);
}

SCENARIO("each line of a longer text has its priority in the journal, and further ones are indented") {
  CHECK(formatted(Stream::journal, "sonopose-x", Level::failure, "one\ntwo") == "<3>one\n<3>  two\n");
}

SCENARIO("a line sends no control characters, and cannot pass for another one") {
  const std::string topic = "/imu\x1b[2J\xc2\x9b\nsonopose-x: error: forged";
  CHECK(formatted(Stream::text, "sonopose-x", Level::warning, topic) ==
        "sonopose-x: warning: /imu\\x1b[2J\\xc2\\x9b\n  sonopose-x: error: forged\n");
  CHECK(formatted(Stream::journal, "sonopose-x", Level::warning, "a\tb") == "<4>a\\x09b\n");
}

SCENARIO("the journal is recognised by the device and inode that systemd announces") {
  int ends[2] = {-1, -1};
  REQUIRE(::pipe(ends) == 0);
  struct stat file {};
  REQUIRE(::fstat(ends[1], &file) == 0);
  const std::string announced = fmt::format("{}:{}", file.st_dev, file.st_ino);
  CHECK(stream_of(ends[1], announced.c_str()) == Stream::journal);
  CHECK(stream_of(ends[1], nullptr) == Stream::text);
  CHECK(stream_of(ends[1], "8:1") == Stream::text);  // redirected by the user
  CHECK(stream_of(ends[1], "") == Stream::text);
  CHECK(stream_of(-1, announced.c_str()) == Stream::text);
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace line_format_test
