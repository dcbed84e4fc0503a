/// A process that is no fusion and writes poses with a higher ownership strength.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"
#include "support/wait_until.hpp"
#include "system/doctor_run.hpp"

#include <fmt/format.h>

namespace sonopose::pose_hijack_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

SCENARIO("a foreign process that writes poses is named, standby fusions are not") {
  GIVEN("a bridge, two standby fusions and a monitor") {
    const Bus bus;
    const auto bridge = bus.bridge({"--scenario", "rest"});
    const auto standby = [&bus](const char* strength) {
      return bus.fusion({"--standby-strength", strength, "--warm-up", "0.2"});
    };
    const auto strong = standby("200");
    const auto weak = standby("100");
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(monitor->wait_for_lines(Stream::output, 3));
    THEN("nothing is reported") {
      CHECK_THAT(monitor->text(Stream::error), !Contains("writes poses") && !Contains("write poses"));
      CHECK_THAT(look(bus.domain_id(), {"--duration", "1"}).output,
                 !Contains("writes poses") && !Contains("write poses"));
      AND_WHEN("a stronger pose writer appears that belongs to no fusion") {
        const auto own = fmt::format("(process {} on ", ::getpid());
        const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
        auto writer = topics::make_writer(participant, dds::qos::Provider(), topics::pose);
        writer.qos(writer.qos() << dds::policy::OwnershipStrength(1000));
        const SteadyTime appeared = clocks::steady_now();
        THEN("the monitor names its process, and so does the doctor") {
          CHECK(monitor->wait_for_line(Stream::error, own));
          fmt::print("named after {:.1f} s\n", seconds_between(appeared, clocks::steady_now()));
          CHECK_THAT(monitor->text(Stream::error), Contains("writes poses with strength"));
          CHECK(monitor->wait_for_line(Stream::output, "writes poses with strength"));
          const std::string finding = "writes poses with strength 1000 and is no fusion";
          const Result result = look_for(finding, bus.domain_id(), {"--duration", "1"});
          CAPTURE(result.output);
          CHECK(result.code == 1);
          CHECK_THAT(result.output, Contains(own) && Contains(finding));
          AND_WHEN("it ends, and a third fusion has the strength of another") {
            writer.close();
            const bool is_over = wait_until([&monitor] {
              return monitor->lines(Stream::output).back().find("\"warnings\":[]") != std::string::npos;
            });
            const auto twin = standby("200");
            THEN("the warning has ended, and both fusions are named") {
              CHECK(is_over);
              REQUIRE(monitor->wait_for_line(Stream::error, "with the same strength 200"));
              for (const auto* const fusion : {strong.get(), twin.get()}) {
                CHECK_THAT(monitor->text(Stream::error),
                           Contains(fmt::format("(process {} on ", fusion->pid())));
              }
            }
          }
        }
      }
    }
  }
}

SCENARIO("a process that poses as a fusion is named when it takes a beacon over") {
  GIVEN("a bridge, a fusion, and a monitor that has its poses and statuses") {
    const Bus bus;
    const auto bridge = bus.bridge({"--scenario", "rest"});
    Consumer<sonopose_FusedPose> poses{bus, topics::pose, topics::Delivery::live};
    const auto fusion = bus.fusion();
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(poses.wait_for_more(1));
    REQUIRE(monitor->wait_for_lines(Stream::output, 6));  // the fusion has owned the beacon for seconds
    WHEN("a stronger writer of poses appears, beside a writer of statuses that it never uses") {
      const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
      auto writer = topics::make_writer(participant, dds::qos::Provider(), topics::pose);
      writer.qos(writer.qos() << dds::policy::OwnershipStrength(900'000));
      const auto statuses = topics::make_writer(participant, dds::qos::Provider(), topics::fusion_status);
      sonopose_FusedPose forged = topics::to_idl(poses.samples.back());
      forged.position.x += 100.0;
      const auto own = fmt::format("(process {} on ", ::getpid());
      THEN("the monitor names its process, and from whom it took the beacon") {
        const bool is_named = wait_until([&] {
          dds::ext::try_write(writer, forged);
          return monitor->text(Stream::error).find("took beacon") != std::string::npos;
        });
        CHECK(is_named);
        CHECK_THAT(monitor->text(Stream::error),
                   Contains(own) && Contains("writes poses with strength 900000 and took beacon") &&
                       Contains(fmt::format("(process {} on ", fusion->pid())));
      }
    }
  }
}

}  // namespace sonopose::pose_hijack_test
