#include <sonopose/text/count_text.hpp>

#include <catch2/catch.hpp>

namespace count_text_test {

using sonopose::text::count_text;
using sonopose::text::first_of;

TEST_CASE("One is singular, everything else plural") {
  CHECK(count_text(0, "beacon") == "0 beacons");
  CHECK(count_text(1, "beacon") == "1 beacon");
  CHECK(count_text(2, "beacon") == "2 beacons");
  CHECK(count_text(1, "event was", "events were") == "1 event was");
  CHECK(count_text(2, "event was", "events were") == "2 events were");
}

TEST_CASE("Several things are the first and the number of the others") {
  CHECK(first_of("a.mcap", 1) == "a.mcap");
  CHECK(first_of("a.mcap", 3) == "a.mcap and 2 more");
}

}  // namespace count_text_test
