/// Two bridges that publish the same address by mistake.

#include "support/bus.hpp"

#include <csignal>

namespace sonopose::two_bridges_test {

using namespace sonopose::test;
namespace topics = dds::topics;

SCENARIO("two bridges with the same address detect and report each other") {
  GIVEN("a running bridge") {
    const Bus bus;
    Consumer<sonopose_BeaconStatus> status(bus, topics::beacon_status, dds::topics::Delivery::live);
    const auto first = bus.bridge({"--scenario", "rest"});
    REQUIRE(status.wait_for_count(1));
    const auto report = [](std::uint32_t others) {
      return [others](const BeaconStatus& latest) {
        return latest.address == 7 && latest.other_bridges == others;
      };
    };
    WHEN("a second one publishes another address, and then a third one the same") {
      const auto another = bus.bridge({"--scenario", "rest", "--address", "8"});
      REQUIRE(status.wait_for([](const BeaconStatus& latest) { return latest.address == 8; }));
      REQUIRE(status.wait_for(report(0), status.samples.size()));
      const std::vector<BeaconStatus> before = status.samples;
      const auto third = bus.bridge({"--scenario", "rest"});
      THEN("the two of the same report it, in their logs and in their status, and the other one does not") {
        CHECK(first->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
        CHECK(third->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
        CHECK(status.wait_for(report(1)));
        for (const BeaconStatus& latest : before) CHECK(latest.other_bridges == 0);
        for (const BeaconStatus& latest : status.samples) {
          if (latest.address == 8) CHECK(latest.other_bridges == 0);
        }
        CHECK_THAT(another->text(Stream::error), !Catch::Contains("another bridge"));
        AND_WHEN("one of them ends") {
          CHECK(third->end_by(SIGINT).code == 0);
          THEN("the status of the other one is clear again") {
            CHECK(status.wait_for(report(0), status.samples.size()));
          }
        }
      }
    }
  }
}

}  // namespace sonopose::two_bridges_test
