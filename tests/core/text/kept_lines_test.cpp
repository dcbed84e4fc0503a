#include <sonopose/text/kept_lines.hpp>

#include <catch2/catch.hpp>

#include <string>

namespace kept_lines_test {

using sonopose::text::KeptLines;

SCENARIO("kept lines are bounded") {
  GIVEN("a program that writes more lines than are kept, in pieces") {
    KeptLines lines;
    for (std::size_t i = 0; i < KeptLines::max_lines + 5; ++i) {
      lines.add("line ");
      lines.add(std::to_string(i) + "\n");
    }
    THEN("the latest are there, and the dropped ones are counted") {
      CHECK(lines.lines().size() == KeptLines::max_lines);
      CHECK(lines.dropped() == 5);
      CHECK(lines.lines().front() == "line 5");
      CHECK(lines.lines().back() == "line " + std::to_string(KeptLines::max_lines + 4));
    }
  }
  GIVEN("a program that writes without an end of the line") {
    KeptLines lines;
    for (int i = 0; i < 100; ++i) lines.add(std::string(100, 'x'));
    lines.add("\nnext\n");
    THEN("the line is cut, and the next one is whole") {
      REQUIRE(lines.lines().size() == 2);
      CHECK(lines.lines().front().size() == KeptLines::max_columns);
      CHECK(lines.lines().back() == "next");
    }
  }
}

}  // namespace kept_lines_test
