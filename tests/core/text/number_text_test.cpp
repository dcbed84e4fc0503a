#include <sonopose/text/number_text.hpp>

#include <catch2/catch.hpp>

#include <limits>

namespace number_text_test {

using sonopose::text::number_text;

TEST_CASE("a number is rounded to its decimals, and has no sign if it rounds to zero") {
  CHECK(number_text(89.6, 0) == "90");
  CHECK(number_text(-89.6, 0) == "-90");
  CHECK(number_text(-0.3, 0) == "0");
  CHECK(number_text(-0.0, 0) == "0");
  CHECK(number_text(-0.0004, 3) == "0.000");
  CHECK(number_text(-0.0006, 3) == "-0.001");
  CHECK(number_text(0.0, 2) == "0.00");
  CHECK(number_text(std::numeric_limits<double>::lowest(), 1).starts_with("-17976931348623157"));
}

}  // namespace number_text_test
