/// Many beacons and a stopped consumer.

#include "support/pose_tap.hpp"

#include <csignal>

namespace load_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr const char* beacons = "25";  // the fusion must not be overloaded
constexpr std::size_t pose_count = 500;
#else
constexpr const char* beacons = "250";
constexpr std::size_t pose_count = 5000;
#endif

SCENARIO("a stopped consumer does not delay others") {
  GIVEN("many beacons and two consumers, one of which stops") {
    const Bus bus;
    PoseTap tap(bus);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--beacons", beacons, "--imu-rate", "25"});
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(monitor->wait_for_lines(Stream::output, 2));
    const auto rate_of = [&tap] {
      const auto poses = tap.wait_for_count(tap.count(), pose_count);
      REQUIRE(poses.size() >= pose_count);
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
