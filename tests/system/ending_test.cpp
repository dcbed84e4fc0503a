/// SIGINT and SIGTERM end every program in any state, immediately and with exit code 0.

#include "support/bus.hpp"
#include "support/temporary_folder.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>

namespace sonopose::ending_test {

using namespace sonopose::test;
namespace topics = dds::topics;
using std::chrono::milliseconds;

milliseconds since(std::chrono::steady_clock::time_point began) {
  return std::chrono::ceil<milliseconds>(std::chrono::steady_clock::now() - began);
}

/// Time that a program currently needs to start, print its version and end.
milliseconds time_of_a_version() {
  const auto began = std::chrono::steady_clock::now();
  REQUIRE(run(SONOPOSE_TEST_FUSION, {"--version"}).code == 0);
  return since(began);
}

/// Rate below which a writer counts as blocked. A writer blocked by a stopped reader still writes some
/// hundred samples per second, because Cyclone DDS grows its buffers slowly. An unblocked one writes many
/// thousands.
constexpr std::size_t slow_per_s = 1000;

/// Compares the time of an ending with that of a version, which a busy machine lengthens as well.
void check_ending(Process& process, int signal) {
  milliseconds version = time_of_a_version();
  const auto began = std::chrono::steady_clock::now();
  process.send(signal);
  auto code = process.wait_for_exit(milliseconds(500));
  while (!code && since(began) < timeout) {
    version = std::max(version, time_of_a_version());
    code = process.wait_for_exit(milliseconds(500));
  }
  const milliseconds took = since(began);
  CAPTURE(signal, version, process.text(Stream::error));
  CHECK(code == 0);
  CHECK(took <= std::max(milliseconds(1000), 50 * version));
}

/// Starts a program twice, waits until both have printed `line`, and ends one with each signal.
template <class Start>
void check_both_signals(Stream stream, const std::string& line, const Start& start) {
  const auto one = start();
  const auto two = start();
  REQUIRE(one->wait_for_line(stream, line));
  REQUIRE(two->wait_for_line(stream, line));
  check_ending(*one, SIGINT);
  check_ending(*two, SIGTERM);
}

SCENARIO("a running chain ends on a signal") {
  GIVEN("two chains in one domain") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto standby = bus.fusion({"--standby-strength", "50"});
    const auto seven = bus.bridge({"--address", "7"});
    const auto eight = bus.bridge({"--address", "8"});
    REQUIRE(poses.wait_for_count(10));
    THEN("its programs end on either signal") {
      check_both_signals(Stream::output, "\"address\":", [&] { return bus.monitor({"--json"}); });
      check_ending(*seven, SIGINT);
      check_ending(*eight, SIGTERM);
      check_ending(*fusion, SIGINT);
      check_ending(*standby, SIGTERM);
    }
  }
}

SCENARIO("waiting programs end on a signal") {
  const Bus bus;
  const TemporaryFolder folder;
  THEN("a bridge that waits for a serial device ends") {
    check_both_signals(Stream::error, "waiting for", [&] {
      return bus.bridge({"--source", "serial", "--device", (folder / "ttyACM0").string()});
    });
  }
  THEN("a bridge that waits for datagrams ends") {
    check_both_signals(Stream::error, "publishing", [&] {
      return bus.bridge({"--source", "udp", "--listen", "127.0.0.1:0"});
    });
  }
  THEN("a bridge with a log that waits for a reader ends") {
    const std::string log = (folder / "log").string();
    REQUIRE(bus.bridge({"--rate", "0", "--duration", "1", "--record", log})->wait_for_exit() == 0);
    check_both_signals(Stream::error, "waiting for a reader", [&] {
      return bus.bridge({"--source", "log", "--input", log});
    });
  }
  THEN("fusion and monitor without a writer end") {
    check_both_signals(Stream::error, "serving", [&] { return bus.fusion(); });
    check_both_signals(Stream::error, "serving", [&] { return bus.fusion({"--lossless"}); });
    check_both_signals(Stream::output, "{", [&] { return bus.monitor({"--json"}); });
  }
}

SCENARIO("a monitor whose output cannot be written ends with an error") {
  const TestDomain domain;
  for (const char* const option : {"", "--json "}) {
    const std::string command =
        std::string("exec \"$0\" ") + option + "--domain " + std::to_string(domain.id()) + " > /dev/full";
    const Result result = run("/bin/sh", {"-c", command, SONOPOSE_TEST_MONITOR}, neutral);
    CAPTURE(option, result.error);
    CHECK(result.code == 1);
    CHECK_THAT(result.error, Catch::Contains("the output cannot be written: No space left on device"));
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
      REQUIRE(seen < 60'000);  // the log is not at its end
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
    // A monitor that has printed a pose is a matched consumer.
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
        bridge->send(SIGTERM);
        CHECK(bridge->wait_for_exit());  // code 1 if it has noticed that its reader has ended
      }
    }
  }
}

}  // namespace sonopose::ending_test
