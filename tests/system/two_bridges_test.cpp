/// Two bridges that publish the same address by mistake.

#include "support/bus.hpp"

#include <csignal>

namespace two_bridges_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

SCENARIO("two bridges with the same address detect and report each other") {
  GIVEN("a running bridge") {
    const Bus bus;
    Consumer<sonopose_BeaconStatus> status(bus, topics::beacon_status, dds::topics::Delivery::live);
    const auto first = bus.bridge({"--scenario", "rest"});
    REQUIRE(status.wait_for_count(2));
    CHECK(status.samples.back().other_bridges == 0);
    WHEN("a second one publishes the same address") {
      const auto second = bus.bridge({"--scenario", "rest"});
      THEN("both report it, in their logs and in their status") {
        CHECK(first->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
        CHECK(second->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
        CHECK(status.wait_for([](const BeaconStatus& latest) { return latest.other_bridges == 1; }));
        AND_WHEN("one of them ends") {
          CHECK(second->end_by(SIGINT).code == 0);
          const std::size_t since = status.samples.size();
          THEN("the status of the other one is clear again") {
            CHECK(
                status.wait_for([](const BeaconStatus& latest) { return latest.other_bridges == 0; }, since));
          }
        }
      }
    }
    WHEN("a second one publishes another address") {
      const auto second = bus.bridge({"--scenario", "rest", "--address", "8"});
      REQUIRE(status.wait_for([](const BeaconStatus& latest) { return latest.address == 8; }));
      REQUIRE(status.wait_for([](const BeaconStatus& latest) { return latest.address == 8; },
                              status.samples.size()));
      THEN("nothing is reported") {
        for (const BeaconStatus& latest : status.samples) CHECK(latest.other_bridges == 0);
        CHECK_THAT(second->text(Stream::error), !Catch::Contains("another bridge"));
      }
    }
  }
}

}  // namespace two_bridges_test
