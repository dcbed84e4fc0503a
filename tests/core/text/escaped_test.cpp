#include <sonopose/text/escaped.hpp>

#include <catch2/catch.hpp>

namespace escaped_test {

using sonopose::text::escaped;
using sonopose::text::printable;

TEST_CASE("control characters of foreign text are shown, and not sent to the terminal") {
  CHECK(escaped("/imu\x1b[2J\n") == "/imu\\x1b[2J\\x0a");
  CHECK(escaped("\x7f") == "\\x7f");
  CHECK(escaped("Größe 3 µT, 漢字 🚀") == "Größe 3 µT, 漢字 🚀");
}

TEST_CASE("control characters of eight bits are shown too, in UTF-8 and alone") {
  CHECK(escaped("/imu\xc2\x9b"
                "2J") == "/imu\\xc2\\x9b2J");
  CHECK(escaped("/imu\x9b"
                "2J") == "/imu\\x9b2J");
}

TEST_CASE("characters that turn the direction of a line, or end it, are shown") {
  CHECK(escaped("a\u202eb\u2028c") == "a\\xe2\\x80\\xaeb\\xe2\\x80\\xa8c");
  CHECK(printable("a\u2066b\u200f") == "a\\u2066b\\u200f");
  CHECK(escaped("שלום, مرحبا") == "שלום, مرحبا");
}

TEST_CASE("bytes that are not UTF-8 are shown as numbers") {
  CHECK(escaped("a\xc3") == "a\\xc3");
  CHECK(escaped("\xc0\xaf") == "\\xc0\\xaf");           // longer than needed
  CHECK(escaped("\xed\xa0\x80") == "\\xed\\xa0\\x80");  // half of a pair of UTF-16
  CHECK(escaped("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
}

TEST_CASE("printed text keeps its lines and columns, and JSON its meaning") {
  CHECK(printable("a\tb\n\x1b[2J\a\r") == "a\tb\n\\u001b[2J\\u0007\\u000d");
  CHECK(printable("{\"name\":\"\x7f\xc2\x9b\"}") == "{\"name\":\"\\u007f\\u009b\"}");
  CHECK(printable("a\xff\xe2\x82z") == "a\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbdz");
  CHECK(printable("Größe 3 µT, 漢字 🚀") == "Größe 3 µT, 漢字 🚀");
}

}  // namespace escaped_test
