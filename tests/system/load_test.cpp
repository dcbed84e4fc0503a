/// Many beacons and a stopped consumer.

#include "support/pose_tap.hpp"

#include <csignal>
#include <map>

namespace sonopose::load_test {

using namespace sonopose::test;
namespace topics = dds::topics;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t beacons = 25;  // the fusion must not be overloaded
#else
constexpr std::size_t beacons = 50;
#endif

SCENARIO("a stopped consumer does not delay others") {
  GIVEN("many beacons and two consumers") {
    const Bus bus;
    const PoseTap tap(bus);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--beacons", std::to_string(beacons), "--imu-rate", "25"});
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(monitor->wait_for_lines(Stream::output, 2));
    WHEN("one of them is stopped for more poses than any buffer holds") {
      constexpr std::size_t poses_each = 64;  // a writer keeps 64 per beacon
      monitor->send(SIGSTOP);
      std::map<BeaconAddress, std::size_t> counts;
      std::size_t complete = 0;
      const auto all_came = tap.wait_for(
          [&](const TappedPose& tapped) {
            if (++counts[tapped.pose.address] == poses_each) ++complete;
            return complete == beacons;
          },
          tap.count());
      const std::size_t statuses = status.samples.size();
      const bool reported = status.wait_for_more(beacons);
      monitor->send(SIGCONT);
      THEN("the other one receives those of every beacon, and every pose is written") {
        CHECK(all_came.has_value());
        REQUIRE(reported);
        for (std::size_t i = statuses; i < status.samples.size(); ++i) {
          CHECK(status.samples[i].poses_unwritten == 0);
        }
      }
    }
  }
}

}  // namespace sonopose::load_test
