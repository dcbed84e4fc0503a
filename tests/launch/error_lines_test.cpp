#include "launch/error_lines.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace error_lines_test {

using namespace sonopose::launch;

SCENARIO("kept lines are bounded") {
  GIVEN("a program that writes more lines than are kept, in pieces") {
    ErrorLines lines;
    for (std::size_t i = 0; i < ErrorLines::most_lines + 5; ++i) {
      lines.add("line ");
      lines.add(std::to_string(i) + "\n");
    }
    THEN("the latest are there, and the dropped ones are counted") {
      CHECK(lines.kept().size() == ErrorLines::most_lines);
      CHECK(lines.dropped() == 5);
      CHECK(lines.kept().front() == "line 5");
      CHECK(lines.kept().back() == "line " + std::to_string(ErrorLines::most_lines + 4));
    }
  }
  GIVEN("a program that writes without an end of the line") {
    ErrorLines lines;
    for (int i = 0; i < 100; ++i) lines.add(std::string(100, 'x'));
    lines.add("\nnext\n");
    THEN("the line is cut, and the next one is whole") {
      REQUIRE(lines.kept().size() == 2);
      CHECK(lines.kept().front().size() == ErrorLines::most_columns);
      CHECK(lines.kept().back() == "next");
    }
  }
}

}  // namespace error_lines_test
