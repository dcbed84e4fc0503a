#include <sonopose/text/escaped.hpp>

#include <catch2/catch.hpp>

namespace escaped_test {

using sonopose::text::escaped;

TEST_CASE("control characters of foreign text are shown, and not sent to the terminal") {
  CHECK(escaped("/imu\x1b[2J\n") == "/imu\\x1b[2J\\x0a");
  CHECK(escaped("\x7f") == "\\x7f");
  CHECK(escaped("Größe 3 µT") == "Größe 3 µT");
}

}  // namespace escaped_test
