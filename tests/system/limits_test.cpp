/// Signals and limits of a service manager, a container or a shell: the table of docs/reliability.md.

#include "marvelmind/decoder.hpp"
#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/terminal_process.hpp"

#include <csignal>
#include <string>
#include <vector>

namespace sonopose::limits_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

/// Lets the programs of a test get SIGHUP as usual, even if the tests run under nohup.
class UsualHangup {
public:
  UsualHangup() : before_(std::signal(SIGHUP, SIG_DFL)) {}
  ~UsualHangup() { std::signal(SIGHUP, before_); }
  UsualHangup(const UsualHangup&) = delete;
  UsualHangup& operator=(const UsualHangup&) = delete;

private:
  void (*before_)(int);
};

SCENARIO("a closed terminal, and the end of the processor time, end programs in good order") {
  const UsualHangup usual;
  const int signal = GENERATE(SIGHUP, SIGXCPU);
  CAPTURE(signal);
  GIVEN("a chain whose bridge records, and a recorder") {
    const Bus bus;
    const TemporaryFolder folder;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto record = bus.record({(folder / "run.mcap").string()});
    REQUIRE(record->wait_for_line(Stream::error, "recording "));
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto monitor = bus.monitor({"--json"});
    const auto settings = bus.settings_watch();
    const auto bridge = bus.bridge({"--record", (folder / "log").string()});
    REQUIRE(poses.wait_for_count(10));
    REQUIRE(monitor->wait_for_line(Stream::output, "\"address\":"));
    REQUIRE(settings->wait_for_line(Stream::error, "watching"));
    WHEN("each gets the signal") {
      for (Process* const process :
           {bridge.get(), record.get(), monitor.get(), settings.get(), relay.get(), fusion.get()}) {
        const auto ending = process->end_by(signal);
        CAPTURE(process->text(Stream::error));
        CHECK(ending.code == 0);
      }
      THEN("the recordings have their end") {
        CHECK(exists(folder / "log"));
        CHECK(exists(folder / "run.mcap"));
        CHECK_FALSE(exists(folder / "run.mcap.part"));
      }
      THEN("the end of the processor time is the stated reason") {
        const std::string said = bridge->text(Stream::error);
        CHECK((said.find("limit of processor time") != std::string::npos) == (signal == SIGXCPU));
      }
    }
  }
}

SCENARIO("a closed terminal ends a full-screen monitor") {
  const UsualHangup usual;
  const Bus bus;
  TerminalProcess monitor(SONOPOSE_TEST_MONITOR, {"--domain", std::to_string(bus.domain_id())});
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({});
  REQUIRE(monitor.wait_for("1 beacon by worst"));
  monitor.send(SIGHUP);
  CHECK(monitor.wait_for_exit() == 0);
  CHECK(monitor.has_normal_line());
}

SCENARIO("a program without the standard streams prints into none of its files") {
  const TemporaryFolder folder;
  const std::string file = (folder / "bytes.bin").string();
  const Bus bus;
  const std::string command = std::string("exec \"$0\" --scenario rest --rate 0 --duration 4 --capture ") +
                              file + " --domain " + std::to_string(bus.domain_id()) + " 0<&- 1>&- 2>&-";
  REQUIRE(run("/bin/sh", {"-c", command, SONOPOSE_TEST_BRIDGE}, neutral).code == 0);
  marvelmind::Decoder decoder;
  decoder.feed(read_bytes(file), [](const marvelmind::Packet&) {});
  CHECK(decoder.counters().frames > 100);
  CHECK(decoder.counters().bytes_lost == 0);
}

SCENARIO("what is printed to a closed standard output is an error") {
  const Result result = run("/bin/sh", {"-c", "exec \"$0\" --version >&-", SONOPOSE_TEST_REPLAY}, neutral);
  CHECK(result.code == 1);
  CHECK_THAT(result.error, Contains("the output cannot be written"));
}

#if !defined(__SANITIZE_THREAD__)  // does not run under a limit of the size of files

SCENARIO("a limit of the size of files is an error that names the file, of any program") {
  const TemporaryFolder folder;
  const std::string log = (folder / "log").string();
  const std::string command = "ulimit -f 16; exec \"$0\" walk --out " + log;
  const Result result = run("/bin/sh", {"-c", command, SONOPOSE_TEST_SIMULATE}, neutral);
  CHECK(result.code == 1);
  CHECK_THAT(result.error, Contains(log) && Contains("File too large"));
}

#endif

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they want to be preloaded first

SCENARIO("with too few threads, every program on the bus refuses to start and names the limits") {
  const TemporaryFolder folder;
  const TestDomain domain;
  const std::vector<Arguments> programs{{SONOPOSE_TEST_BRIDGE},
                                        {SONOPOSE_TEST_FUSION},
                                        {SONOPOSE_TEST_MONITOR},
                                        {SONOPOSE_TEST_DOCTOR},
                                        {SONOPOSE_TEST_SETTINGS, "watch"},
                                        {SONOPOSE_TEST_ROS2, "--network", "loopback"},
                                        {SONOPOSE_TEST_RECORD, (folder / "run.mcap").string()}};
  Environment environment = neutral;
  environment["ROS_DOMAIN_ID"] = std::to_string(domain.id());
  environment["LD_PRELOAD"] = SONOPOSE_TEST_FEW_THREADS;
  for (const Arguments& program : programs) {
    for (const char* const limit : {"1", "2", "3", "4", "6", "9"}) {
      environment["SONOPOSE_TEST_MAX_THREADS"] = limit;
      const Result result = run(program.front(), {program.begin() + 1, program.end()}, environment);
      CAPTURE(program.front(), limit, result.error);
      CHECK(result.code == 1);
      CHECK_THAT(result.error, Contains("ulimit -u") && Contains("TasksMax=") && Contains("--pids-limit"));
    }
  }
}

#endif

}  // namespace sonopose::limits_test
