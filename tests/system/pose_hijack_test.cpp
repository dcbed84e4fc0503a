/// A process that is no fusion and writes poses with a higher ownership strength.

#include "support/bus.hpp"

#include <fmt/format.h>

namespace pose_hijack_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

/// The promise is 2 s. Sanitizers take longer.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::chrono::milliseconds limit{10'000};
#else
constexpr std::chrono::milliseconds limit{2'000};
#endif

SCENARIO("a foreign process that writes poses is named, standby fusions are not") {
  GIVEN("a bridge, two standby fusions and a monitor") {
    const Bus bus;
    const auto bridge = bus.bridge({"--scenario", "rest"});
    const auto strong = bus.fusion({"--standby-strength", "200", "--warm-up", "0.2"});
    const auto weak = bus.fusion({"--standby-strength", "100", "--warm-up", "0.2"});
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(monitor->wait_for_lines(Stream::output, 4));
    const Arguments doctor{"--duration", "1", "--domain", std::to_string(bus.domain_id())};
    const auto own = fmt::format("(process {} on ", ::getpid());
    THEN("nothing is reported") {
      CHECK_THAT(monitor->text(Stream::error), !Contains("writes poses") && !Contains("write poses"));
      CHECK_THAT(run(SONOPOSE_TEST_DOCTOR, doctor).output,
                 !Contains("writes poses") && !Contains("write poses"));
    }
    WHEN("a stronger pose writer appears that belongs to no fusion") {
      const dds::DomainParticipant participant({.domain_id = bus.domain_id()});
      auto writer = topics::make_writer(participant, dds::qos::Provider(), topics::pose);
      writer.ownership_strength(1000);
      THEN("the monitor names its process within 2 s, and so does the doctor") {
        CHECK(monitor->wait_for_line(Stream::error, own, limit));
        CHECK_THAT(monitor->text(Stream::error), Contains("writes poses with strength"));
        const Result result = run(SONOPOSE_TEST_DOCTOR, doctor);
        CAPTURE(result.output);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains(own) && Contains("writes poses with strength 1000 and is no fusion"));
        AND_WHEN("it ends") {
          writer.close();
          const std::size_t since = monitor->lines(Stream::output).size();
          REQUIRE(monitor->wait_for_lines(Stream::output, since + 3));
          THEN("the warning ends") {
            CHECK_THAT(monitor->lines(Stream::output).back(), Contains("\"warnings\":[]"));
          }
        }
      }
    }
    WHEN("a third fusion has the strength of another") {
      const auto twin = bus.fusion({"--standby-strength", "200", "--warm-up", "0.2"});
      THEN("both are named") {
        REQUIRE(monitor->wait_for_line(Stream::error, "with the same strength 200"));
        for (const auto* const fusion : {strong.get(), twin.get()}) {
          CHECK_THAT(monitor->text(Stream::error), Contains(fmt::format("(process {} on ", fusion->pid())));
        }
      }
    }
  }
}

}  // namespace pose_hijack_test
