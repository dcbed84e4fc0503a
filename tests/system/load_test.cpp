/// Many beacons and a stopped consumer.

#include "support/pose_tap.hpp"

#include <csignal>

namespace load_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

SCENARIO("a stopped consumer does not delay others", "[load]") {
  GIVEN("250 beacons and two consumers, one of which stops") {
    const Bus bus;
    PoseTap tap(bus);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--beacons", "250", "--imu-rate", "25"});
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(monitor->wait_for_lines(Stream::output, 2));
    const auto rate_of = [&tap] {
      const auto poses = tap.wait_for_count(tap.count(), 5000);
      REQUIRE(poses.size() >= 5000);
      return static_cast<double>(poses.size()) /
             (static_cast<double>(poses.back().received - poses.front().received) * 1e-9);
    };
    const double before_hz = rate_of();
    monitor->send(SIGSTOP);
    THEN("the other consumer receives as many poses as before, and every pose is written") {
      for (int i = 0; i < 3; ++i) CHECK(rate_of() > 0.8 * before_hz);
      CHECK(status.wait_for([](const FusionStatus&) { return true; }, status.samples.size()));
      for (const FusionStatus& latest : status.samples) CHECK(latest.poses_unwritten == 0);
    }
    monitor->send(SIGCONT);
  }
}

}  // namespace load_test
