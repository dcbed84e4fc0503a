#include <sonopose/text/size_text.hpp>

#include <catch2/catch.hpp>

namespace size_text_test {

using sonopose::text::bytes_of;
using sonopose::text::size_text;

TEST_CASE("a size is a number with a unit, whole or not") {
  CHECK(bytes_of("0.5MB") == 500'000.0);
  CHECK(bytes_of("1.5 GB") == 1.5e9);
  CHECK(bytes_of("1e6") == 1e6);
  CHECK(bytes_of("64k") == 64'000.0);
  CHECK(bytes_of("2GiB") == 2147483648.0);
  CHECK(bytes_of("1kib") == 1024.0);
  CHECK(bytes_of("12 b") == 12.0);
  CHECK(bytes_of("1EB") == 1e18);
  CHECK(bytes_of("0.25Ti") == 274877906944.0);
}

TEST_CASE("other texts are no size") {
  for (const char* const text :
       {"", "MB", "-1MB", "1,5MB", "1MBit", "1xB", "nan", "inf", "1e308EB", "5 MB x", "0x10", "1e", "1 E"}) {
    CAPTURE(text);
    CHECK_FALSE(bytes_of(text));
  }
}

TEST_CASE("a size is shown in its largest unit") {
  CHECK(size_text(12) == "12 B");
  CHECK(size_text(1e6) == "1 MB");
  CHECK(size_text(1.5e9) == "1.5 GB");
  CHECK(size_text(1e18) == "1 EB");
  CHECK(size_text(999'900) == "999.9 kB");
  CHECK(size_text(999'999) == "1 MB");
}

}  // namespace size_text_test
