/// Processes that die and come back.

#include "support/bus.hpp"

#include <csignal>

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

namespace {

bool is_ready(const FusedPose& pose) {
  return (pose.status & status_initialising) == 0U;
}

}  // namespace

SCENARIO("a bridge that was killed is started again") {
  GIVEN("a chain at work") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::Delivery::live);
    const auto fusion = bus.fusion();
    auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("its bridge is killed, and a new one counts its events from 1 again") {
      bridge->send(SIGKILL);
      REQUIRE(bridge->wait_for_exit() == -SIGKILL);
      poses.take();
      const std::size_t before = poses.samples.size();
      const TimeNs last_ns = poses.samples.back().time_ns;
      bridge = bus.bridge({"--scenario", "rest"});
      THEN("poses come again, from the same fusion, which counts what has happened") {
        REQUIRE(poses.wait_for_count(before + 200));
        CHECK(poses.samples.back().time_ns > last_ns);
        CHECK(is_ready(poses.samples.back()));
        CHECK(poses.samples.back().sequence < 1000);  // the new bridge's numbers
        REQUIRE(status.wait_for(
            [last_ns](const FusionStatus& told) { return told.time_ns > last_ns + 2'000'000'000; }));
        // Numbers that were there already, until it was sure that the counting has begun anew.
        CHECK(status.samples.back().events_duplicated >= 1);
        CHECK(status.samples.back().events_duplicated < 10);
        CHECK(fusion->wait_for_exit(std::chrono::milliseconds(0)) == std::nullopt);
      }
    }
  }
}

SCENARIO("a fusion that was killed is started again") {
  GIVEN("a chain at work") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("it is killed and started again") {
      fusion->send(SIGKILL);
      REQUIRE(fusion->wait_for_exit() == -SIGKILL);
      poses.take();
      const std::size_t before = poses.samples.size();
      fusion = bus.fusion();
      THEN("it takes the running stream up, initialises anew, and the bridge goes on undisturbed") {
        REQUIRE(poses.wait_for([](const FusedPose& pose) { return !is_ready(pose); }, before));
        REQUIRE(poses.wait_for(is_ready, before));
        imu.take();
        for (std::size_t i = 1; i < imu.samples.size(); ++i) {
          const TimeNs step_ns = imu.samples[i].sensor_time_ns - imu.samples[i - 1].sensor_time_ns;
          REQUIRE(step_ns == Approx(10e6).margin(1000));
        }
        CHECK(bridge->wait_for_exit(std::chrono::milliseconds(0)) == std::nullopt);
      }
    }
  }
}
