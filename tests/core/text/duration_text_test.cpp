#include <sonopose/text/duration_text.hpp>

#include <catch2/catch.hpp>

namespace duration_text_test {

using sonopose::text::duration_text;

TEST_CASE("a duration has the largest unit of which it has two") {
  CHECK(duration_text(0.04) == "0.0 s");
  CHECK(duration_text(119.9) == "119.9 s");
  CHECK(duration_text(120.0) == "2.0 min");
  CHECK(duration_text(3 * 3600.0) == "3.0 h");
  CHECK(duration_text(36 * 3600.0) == "36.0 h");
  CHECK(duration_text(60 * 86400.0) == "60.0 d");
  CHECK(duration_text(56.25 * 365.25 * 86400) == "56.2 years");
}

}  // namespace duration_text_test
