/// Processes that are killed and restarted.

#include "marvelmind/encoder.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"

#include <csignal>
#include <cstdint>
#include <string>

namespace sonopose::restart_test {

using namespace sonopose::test;
namespace topics = dds::topics;

bool is_ready(const FusedPose& pose) {
  return (pose.status & status_initialising) == 0U;
}

SCENARIO("a bridge is killed and restarted") {
  GIVEN("a running chain") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    // At 500 Hz the numbers rise so fast that a new bridge's are lower even if it is discovered late.
    auto bridge = bus.bridge({"--scenario", "rest", "--imu-rate", "500"});
    REQUIRE(poses.wait_for([](const FusedPose& pose) { return is_ready(pose) && pose.sequence > 500; }));
    WHEN("the bridge is killed, and a new one numbers its events from 1") {
      bridge->send(SIGKILL);
      REQUIRE(bridge->wait_for_exit() == -SIGKILL);
      poses.take();
      const std::size_t before = poses.samples.size();
      const TimeNs last_ns = poses.samples.back().time_ns;
      const std::uint64_t last_sequence = poses.samples.back().sequence;
      bridge = bus.bridge({"--scenario", "rest"});
      THEN("poses resume from the same fusion") {
        REQUIRE(poses.wait_for(
            [&](const FusedPose& pose) {
              return is_ready(pose) && pose.time_ns > last_ns && pose.sequence < last_sequence;
            },
            before));
        const TimeNs resumed_ns = poses.samples.back().time_ns;
        REQUIRE(status.wait_for(
            [resumed_ns](const FusionStatus& latest) { return latest.time_ns > resumed_ns; }));
        CHECK(status.samples.back().events_duplicated < 100);
        CHECK(fusion->wait_for_exit(std::chrono::milliseconds(0)) == std::nullopt);
      }
    }
  }
}

SCENARIO("a fusion is killed and restarted") {
  GIVEN("a running chain") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("the fusion is killed and restarted") {
      fusion->send(SIGKILL);
      REQUIRE(fusion->wait_for_exit() == -SIGKILL);
      poses.take();
      const std::size_t before = poses.samples.size();
      fusion = bus.fusion();
      THEN("it joins the running stream and initialises again, and the bridge continues undisturbed") {
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

/// A packet of telemetry.
std::string bytes_of_beacon(std::uint8_t address) {
  const marvelmind::Frame frame = marvelmind::encode(marvelmind::Telemetry{.address = address});
  return {frame.bytes().begin(), frame.bytes().end()};
}

SCENARIO("a bridge that an error ends states the reason and the restart that helps") {
  GIVEN("a bridge that plays a file, and a reader of each of its streams") {
    const Bus bus;
    const Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    const Consumer<sonopose_PairHeading> headings(bus, topics::heading);
    WHEN("the file has one beacon more than are allowed") {
      const TemporaryFolder folder;
      const std::string file = (folder / "bytes.bin").string();
      write_text(file, bytes_of_beacon(5) + bytes_of_beacon(6));
      const auto bridge = bus.bridge({"--source", "stream", "--input", file, "--max-beacons", "1"});
      THEN("it ends with exit code 1, the reason, and what to restart") {
        CHECK(bridge->wait_for_exit() == 1);
        CHECK_THAT(bridge->text(Stream::error),
                   Catch::Contains(file + ": beacon 6 is one more than --max-beacons 1; restart "
                                          "sonopose-bridge; no other program needs a restart"));
      }
    }
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // the sanitizers replace the allocator

/// A program in which one allocation fails after SIGUSR1 (support/failing_allocation.cpp).
std::unique_ptr<Process> failing(const Bus& bus, const char* program, Arguments arguments,
                                 const std::string& allocation) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(bus.domain_id())});
  return std::make_unique<Process>(program, arguments,
                                   Environment{{"LD_PRELOAD", SONOPOSE_TEST_FAILING_ALLOCATION},
                                               {"SONOPOSE_TEST_FAILING_ALLOCATION", allocation}});
}

void check_reason(Process& process, const std::string& program) {
  CHECK(process.wait_for_exit() == 1);
  CHECK_THAT(process.text(Stream::error),
             Catch::Contains("std::bad_alloc; restart " + program + "; no other program needs a restart"));
}

SCENARIO("a program that an exception ends, on any thread, states the reason and the restart that helps") {
  // Samples are received on a thread of Cyclone DDS, which cannot catch an exception.
  const std::string thread = GENERATE("main", "recv");
  CAPTURE(thread);
  const Bus bus;
  WHEN("a fusion has no memory for a new beacon") {
    const auto fusion = failing(bus, SONOPOSE_TEST_FUSION, {}, thread);
    REQUIRE(fusion->wait_for_line(Stream::error, "serving"));
    fusion->send(SIGUSR1);
    const auto bridge = bus.bridge({"--scenario", "rest"});
    THEN("it ends, and the bridge continues") {
      check_reason(*fusion, "sonopose-fusion");
      CHECK(bridge->wait_for_exit(std::chrono::milliseconds(0)) == std::nullopt);
    }
  }
  WHEN("a relay has no memory for a new beacon") {
    const auto relay = failing(bus, SONOPOSE_TEST_ROS2, {"--network", "loopback"}, thread);
    REQUIRE(relay->wait_for_line(Stream::error, "relaying as"));
    const auto fusion = bus.fusion();
    relay->send(SIGUSR1);
    const auto bridge = bus.bridge({"--scenario", "rest"});
    THEN("it ends, and the fusion continues") {
      check_reason(*relay, "sonopose-ros2");
      CHECK(fusion->wait_for_exit(std::chrono::milliseconds(0)) == std::nullopt);
    }
  }
}

SCENARIO("a request for settings that cannot be answered for want of memory does not end the fusion") {
  // Longer than any other text, so that its copy is the failing allocation.
  const std::string value = "0.25" + std::string(119, '0');
  const Bus bus;
  const auto fusion = failing(bus, SONOPOSE_TEST_FUSION, {}, "=" + std::to_string(value.size() + 1));
  REQUIRE(fusion->wait_for_line(Stream::error, "serving"));
  fusion->send(SIGUSR1);
  const Result set = bus.settings({"set", "documented.trust.sigma_m=" + value});
  CAPTURE(set.output, set.error);
  CHECK(fusion->wait_for_line(Stream::error, "std::bad_alloc"));
  CHECK(fusion->wait_for_exit(std::chrono::milliseconds(0)) == std::nullopt);
  // The client repeats its request; in any case the next one must be answered.
  CHECK(bus.settings({"set", "documented.trust.sigma_m=0.5"}).code == 0);
}

#endif

}  // namespace sonopose::restart_test
