/// SIGINT and SIGTERM end every program in any state, within a second and with exit code 0.

#include "support/bus.hpp"
#include "support/temporary_folder.hpp"

#include <csignal>

namespace ending_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;
using std::chrono::milliseconds;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr milliseconds limit{5000};  // includes the work of a sanitizer at exit
#else
constexpr milliseconds limit{1000};
#endif

/// A writer that is blocked by a stopped reader still writes some hundred samples per second, because Cyclone
/// DDS grows its buffers slowly; an unblocked one writes many thousands.
constexpr std::size_t slow_per_s = 1000;

void check_ending(Process& process, int signal) {
  const auto ending = process.end_by(signal);
  CAPTURE(signal, process.text(Stream::error));
  CHECK(ending.code == 0);
  CHECK(ending.took <= limit);
}

SCENARIO("a running chain ends on a signal") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(poses.wait_for_count(10));
    REQUIRE(monitor->wait_for_lines(Stream::output, 1));
    check_ending(*monitor, signal);
    check_ending(*bridge, signal);
    check_ending(*fusion, signal);
  }
}

SCENARIO("waiting programs end on a signal") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Bus bus;
    const TemporaryFolder folder;
    WHEN("a bridge waits for a serial device " + std::to_string(signal)) {
      const auto bridge = bus.bridge({"--source", "serial", "--device", (folder / "ttyACM0").string()});
      REQUIRE(bridge->wait_for_line(Stream::error, "waiting for"));
      check_ending(*bridge, signal);
    }
    WHEN("a bridge waits for datagrams " + std::to_string(signal)) {
      const auto bridge = bus.bridge({"--source", "udp", "--listen", "127.0.0.1:0"});
      REQUIRE(bridge->wait_for_line(Stream::error, "publishing"));
      check_ending(*bridge, signal);
    }
    WHEN("a bridge with a log waits for a reader " + std::to_string(signal)) {
      const std::string log = (folder / "log").string();
      REQUIRE(bus.bridge({"--rate", "0", "--duration", "1", "--record", log})->wait_for_exit() == 0);
      const auto bridge = bus.bridge({"--source", "log", "--input", log});
      REQUIRE(bridge->wait_for_line(Stream::error, "waiting for a reader"));
      check_ending(*bridge, signal);
    }
    WHEN("fusion and monitor have no writer " + std::to_string(signal)) {
      const auto fusion = bus.fusion();
      const auto lossless = bus.fusion({"--lossless"});
      const auto monitor = bus.monitor({"--json"});
      REQUIRE(monitor->wait_for_lines(Stream::output, 1));
      check_ending(*lossless, signal);
      check_ending(*fusion, signal);
      check_ending(*monitor, signal);
    }
  }
}

SCENARIO("a bridge that is blocked by a stopped reader ends on a signal") {
  GIVEN("a long log, a lossless fusion, and a bridge that plays the log as fast as possible") {
    const Bus bus;
    const TemporaryFolder folder;
    const std::string log = (folder / "log").string();
    REQUIRE(bus.bridge({"--rate", "0", "--duration", "600", "--record", log})->wait_for_exit() == 0);
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto fusion = bus.fusion({"--lossless"});
    const auto bridge = bus.bridge({"--source", "log", "--input", log, "--rate", "0"});
    REQUIRE(imu.wait_for_count(100));
    WHEN("the fusion is stopped and blocks the bridge at most samples") {
      fusion->send(SIGSTOP);
      std::size_t seen = 0;
      do {
        seen = imu.samples.size();
      } while (imu.wait_for_count(seen + slow_per_s, milliseconds(1000)));
      REQUIRE(seen < 60'000);  // the log had not ended
      THEN("the bridge ends at once, and the fusion when it continues") {
        check_ending(*bridge, SIGINT);
        fusion->send(SIGCONT);
        check_ending(*fusion, SIGINT);
      }
    }
  }
}

SCENARIO("a fusion that is blocked by a stopped consumer ends on a signal") {
  GIVEN("a long log, a lossless fusion, and a consumer that does not take samples") {
    const Bus bus;
    const TemporaryFolder folder;
    const std::string log = (folder / "log").string();
    REQUIRE(bus.bridge({"--rate", "0", "--duration", "600", "--record", log})->wait_for_exit() == 0);
    const std::string short_log = (folder / "short").string();
    REQUIRE(bus.bridge({"--rate", "0", "--duration", "2", "--record", short_log})->wait_for_exit() == 0);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status);
    const auto monitor = bus.monitor({"--json"});
    const auto fusion = bus.fusion({"--lossless"});
    // Once the monitor has printed a pose, it is a matched consumer.
    REQUIRE(bus.bridge({"--source", "log", "--input", short_log, "--rate", "0", "--address", "8"})
                ->wait_for_exit() == 0);
    REQUIRE(monitor->wait_for_line(Stream::output, "\"address\":8"));
    monitor->send(SIGSTOP);
    const auto bridge = bus.bridge({"--source", "log", "--input", log, "--rate", "0"});
    WHEN("the consumer blocks it at most poses") {
      std::uint64_t before = 0;
      REQUIRE(status.wait_for([&before](const FusionStatus& latest) {
        if (latest.address != 7) return false;
        const bool slow = before > 0 && latest.imu_samples - before < slow_per_s;
        before = latest.imu_samples;
        return slow;
      }));
      REQUIRE(status.samples.back().imu_samples < 60'000);
      THEN("the fusion and the bridge end") {
        check_ending(*fusion, SIGTERM);
        check_ending(*bridge, SIGTERM);
      }
    }
  }
}

}  // namespace ending_test
