#include "clocks/utc_time.hpp"

#include <catch2/catch.hpp>

namespace utc_time_test {

using sonopose::clocks::utc_time_ns;

TEST_CASE("a date has the nanoseconds since 1970, in any zone") {
  CHECK(utc_time_ns("1970-01-02 00:00:00") == 86'400'000'000'000);
  CHECK(utc_time_ns("1970-01-01T00:01Z") == 60'000'000'000);
  CHECK(utc_time_ns("2000-03-01 00:00:00.000000001 UTC") == 951'868'800'000'000'001);
  CHECK(utc_time_ns("2000-03-01T01:30:00+01:30") == 951'868'800'000'000'000);
  CHECK(utc_time_ns("02.01.1970 00:00:00.5") == 86'400'500'000'000);
  CHECK(utc_time_ns("2000-02-29T19:00:00-0500") == 951'868'800'000'000'000);
}

TEST_CASE("other texts and impossible dates are no time") {
  for (const char* const text : {"", "2000-03-01", "2001-02-29 00:00", "2000-03-01 24:00",
                                 "2000-03-01 00:00:60", "2000-03-01 00:00:00.", "2000-03-01 00:00 CET",
                                 "1970-01-01T00:00+01:00", "1.5", "12/01/2026 00:00", "31.02.2000 00:00"}) {
    CAPTURE(text);
    CHECK_FALSE(utc_time_ns(text).has_value());
  }
}

}  // namespace utc_time_test
