#include "mcap/omg_idl.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace omg_idl_test {

using Catch::Contains;
using sonopose::mcap::definition_in;

const std::string text = R"(
  // A comment.
  module m {
    const unsigned long SIZE = 3;  // of an array
    typedef double Row[SIZE];
    @final struct Vector { double x; /* up */ double y; };
    struct Sample { @key long address; Vector at; Row row; };
    struct Other { long a; };
  };
)";

TEST_CASE("the definition of a type has those that it uses, and no others") {
  const std::string sample = definition_in(text, "m::Sample");
  CHECK_THAT(sample, Contains("struct Sample { @ key long address ; Vector at ; Row row ;") &&
                         Contains("struct Vector { double x ; double y ;") &&
                         Contains("typedef double Row [ SIZE ]") && Contains("const unsigned long SIZE = 3"));
  CHECK_THAT(sample, !Contains("Other"));
  CHECK(definition_in(text, "m::None").empty());
  CHECK(definition_in("", "m::Sample").empty());
}

TEST_CASE("only what has a meaning differs") {
  const auto replaced = [](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return definition_in(other, "m::Sample");
  };
  const std::string sample = definition_in(text, "m::Sample");
  CHECK(replaced("/* up */", "\n// another comment\n") == sample);
  CHECK(replaced("long a;", "double a;") == sample);  // in another type
  CHECK(replaced("double y;", "float y;") != sample);
  CHECK(replaced("= 3", "= 4") != sample);
  CHECK(replaced("@key long address", "long address") != sample);
}

TEST_CASE("a text of any size and content takes no longer than its length") {
  std::string open;
  for (int i = 0; i < 200'000; ++i) open += "struct A" + std::to_string(i) + " { ";
  CHECK_FALSE(definition_in(open, "A0").empty());
  for (const char* const cut : {"struct", "struct A {", "/* no end", "/*/", "typedef", "const x ="}) {
    CHECK_NOTHROW(definition_in(cut, "A"));
  }
}

}  // namespace omg_idl_test
