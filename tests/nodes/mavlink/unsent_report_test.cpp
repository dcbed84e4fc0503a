#include "mavlink/sender/unsent_report.hpp"

#include <catch2/catch.hpp>

namespace unsent_report_test {

using sonopose::mavlink::sender::UnsentReport;
using sonopose::transport::SendFailures;

SCENARIO("a line that does not take messages is reported with the cause") {
  UnsentReport report;
  constexpr SendFailures none{};
  CHECK_FALSE(report.update(0, none));
  GIVEN("a network that is unreachable") {
    const SendFailures first{.count = 3, .reason = std::errc::network_unreachable};
    const auto news = report.update(0, first);
    REQUIRE(news);
    CHECK(news->is_warning);
    CHECK_THAT(news->text, Catch::Contains("sending fails: Network is unreachable"));
    CHECK_FALSE(report.update(0, {.count = 6, .reason = std::errc::network_unreachable}));
    WHEN("it comes back within a second in which messages still failed") {
      CHECK_FALSE(report.update(0, {.count = 7, .reason = std::errc::network_unreachable}));
      THEN("the next second is good, and no line was called too slow") {
        const auto again = report.update(0, {.count = 7, .reason = std::errc::network_unreachable});
        REQUIRE(again);
        CHECK_FALSE(again->is_warning);
        CHECK(again->text == "sending works again");
      }
    }
    WHEN("the cause changes") {
      const auto other = report.update(0, {.count = 9, .reason = std::errc::permission_denied});
      THEN("the new one is reported") {
        REQUIRE(other);
        CHECK_THAT(other->text, Catch::Contains("Permission denied"));
      }
    }
  }
  GIVEN("a slow line") {
    const auto news = report.update(5, none);
    THEN("a lower rate is advised, once") {
      REQUIRE(news);
      CHECK(news->is_warning);
      CHECK_THAT(news->text, Catch::Contains("--rate"));
      CHECK_FALSE(report.update(9, none));
    }
  }
}

}  // namespace unsent_report_test
