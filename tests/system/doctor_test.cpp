/// The doctor on healthy systems, and on systems with one fault.

#include "support/bus.hpp"
#include "support/terminal_process.hpp"
#include "system/doctor_run.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <random>
#include <sys/socket.h>
#include <unistd.h>

namespace doctor_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

bool is_ready(const FusedPose& pose) {
  constexpr std::uint32_t not_yet = status_initialising | status_uncalibrated | status_heading_unknown;
  return (pose.status & not_yet) == 0U;
}

SCENARIO("the doctor finds no problem in a healthy system") {
  GIVEN("a running bridge, fusion and consumer") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("the doctor runs") {
      const Result result = doctor(bus.domain_id(), {"--duration", "3"});
      THEN("it reports no problem, and the rates") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 0);
        CHECK_THAT(result.output, Contains("no problems found") && Contains("beacon 7: IMU "));
        CHECK_THAT(result.output, Contains("domain " + std::to_string(bus.domain_id())));
      }
    }
    WHEN("JSON is requested") {
      const Result result = doctor(bus.domain_id(), {"--json", "--duration", "1"});
      THEN("the output is one object") {
        const auto report = nlohmann::json::parse(result.output);
        CHECK(report["ok"] == true);
        CHECK(report["findings"].size() >= 2);
      }
    }
    WHEN("a consumer requests shared ownership") {
      const dds::DomainParticipant participant({.domain_id = bus.domain_id()});
      const dds::Topic<sonopose_FusedPose> topic(participant, topics::pose.name);
      const dds::DataReader<sonopose_FusedPose> shared(participant, topic);
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("it is named, with the policy and the remedy") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("test_system_doctor (process " + std::to_string(::getpid()) + " on "));
        CHECK_THAT(result.output, Contains("cannot receive from") &&
                                      Contains("sonopose-fusion (process " + std::to_string(fusion->pid())));
        CHECK_THAT(result.output, Contains("ownership: offered exclusive, requested shared"));
      }
    }
    WHEN("a second bridge publishes the same beacon") {
      const auto second = bus.bridge({});
      REQUIRE(second->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("both are reported") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output, Contains("beacon 7: 2 bridges publish it"));
        for (const auto* const process : {bridge.get(), second.get()}) {
          CHECK_THAT(result.output, Contains("process " + std::to_string(process->pid())));
        }
      }
    }
    WHEN("the fusion ends") {
      REQUIRE(fusion->end_by(SIGINT).code == 0);
      const auto began = std::chrono::steady_clock::now();
      const Result result = doctor(bus.domain_id(), {"--duration", "2"});
      const auto took = std::chrono::steady_clock::now() - began;
      THEN("the doctor soon reports that it is missing, and that the beacon is healthy") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        // 2 s, a second for discovery, and at most 12 s for the domains of others; without a limit it took
        // more.
        CHECK(took < std::chrono::seconds(20));
        // The remedy depends on other processes of this machine.
        CHECK_THAT(result.output, Contains("no fusion runs in domain " + std::to_string(bus.domain_id())));
        CHECK_THAT(result.output, !Contains("no bridge publishes"));
      }
    }
  }
}

SCENARIO("the doctor detects a rotated IMU at rest") {
  GIVEN("a level beacon at rest, and a fusion whose settings make the sensor's Y vertical") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion({"--set", "calibration.axes=+x-z+y"});
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for_count(1));
    WHEN("the doctor runs") {
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("it reports the direction of gravity and the setting that corrects it") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output, Contains("along -y of the body instead of +z"));
        CHECK_THAT(result.output, Contains("calibration.axes=+x+y+z;"));
      }
    }
  }
}

SCENARIO("the doctor reports an empty domain, and finds a system in another domain") {
  const Bus empty;
  GIVEN("an empty domain") {
    WHEN("the doctor runs") {
      const Result result = doctor(empty.domain_id(), {"--duration", "0.5"});
      THEN("it reports an error") {
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("no sonopose process in domain " + std::to_string(empty.domain_id())));
      }
    }
  }
  GIVEN("a bridge in another domain") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = bus.bridge({});
    REQUIRE(imu.wait_for_count(1));
    WHEN("the doctor checks another domain") {
      const std::string used = std::to_string(bus.domain_id());
      const Result result = doctor(empty.domain_id(), {"--duration", "0.5"});
      THEN("it names the correct domain") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("beacons are published in domain " + used + ": use --domain " + used));
      }
    }
  }
}

/// UDP ports in use, each of another domain.
class OccupiedDomains {
public:
  OccupiedDomains(unsigned first, unsigned last) {
    for (unsigned id = first; id <= last; ++id) {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * id + 100));  // of no likely process
      const int file = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      REQUIRE(file >= 0);
      files_.push_back(file);
      const bool bound = ::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
      REQUIRE((bound || errno == EADDRINUSE));  // a socket of another process serves as well
    }
  }
  OccupiedDomains(const OccupiedDomains&) = delete;
  OccupiedDomains& operator=(const OccupiedDomains&) = delete;
  ~OccupiedDomains() {
    for (const int file : files_) ::close(file);
  }

private:
  std::vector<int> files_;
};

std::size_t entries_of(const std::filesystem::path& folder) {
  std::error_code ended;
  std::size_t count = 0;
  for (auto entry = std::filesystem::directory_iterator(folder, ended);
       !ended && entry != std::filesystem::directory_iterator(); entry.increment(ended)) {
    ++count;
  }
  return count;
}

/// What the doctor used while it searched, with a limit of file descriptors.
struct SearchUsage {
  std::optional<int> code;
  std::string output;
  std::size_t most_threads = 0;
  std::size_t most_files = 0;
  double took_s = 0;
};

SearchUsage search(std::uint32_t domain_id, unsigned descriptors) {
  const std::string command =
      "ulimit -n " + std::to_string(descriptors) + " && exec \"$0\" --domain " + std::to_string(domain_id);
  const auto began = std::chrono::steady_clock::now();
  Process process("/bin/sh", {"-c", command, SONOPOSE_TEST_DOCTOR}, neutral);
  const std::filesystem::path folder = "/proc/" + std::to_string(process.pid());
  SearchUsage usage;
  while (!usage.code && std::chrono::steady_clock::now() - began < timeout) {
    usage.most_threads = std::max(usage.most_threads, entries_of(folder / "task"));
    usage.most_files = std::max(usage.most_files, entries_of(folder / "fd"));
    usage.code = process.wait_for_exit(std::chrono::milliseconds(5));
  }
  usage.took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  usage.output = process.text(Stream::output);
  return usage;
}

SCENARIO("the doctor's search of all domains is bounded") {
  GIVEN("an empty domain, and programs in 132 others") {
    const Bus empty;
    const OccupiedDomains others(101, 232);
    WHEN("a bridge runs in any of them") {
      std::random_device random;
      const auto used = std::uniform_int_distribution<unsigned>(101, 232)(random);
      CAPTURE(used);
      Process bridge(SONOPOSE_TEST_BRIDGE, {"--scenario", "rest", "--domain", std::to_string(used)}, neutral);
      REQUIRE(bridge.wait_for_line(Stream::error, "found"));
      const SearchUsage usage = search(empty.domain_id(), 1024);
      CAPTURE(usage.output, usage.took_s);
      THEN("the doctor finds it within 15 s") {
        CHECK(usage.code == 1);
        CHECK_THAT(usage.output, Contains("beacons are published in domain " + std::to_string(used) + ":"));
        CHECK(usage.took_s < 15);
      }
    }
    WHEN("the doctor may open 1024 files") {
      const SearchUsage usage = search(empty.domain_id(), 1024);
      CAPTURE(usage.output, usage.took_s, usage.most_threads, usage.most_files);
      THEN("it visits all, with less than 200 threads, within 15 s") {
        CHECK(usage.code == 1);
        CHECK_THAT(usage.output, Contains("no sonopose process"));
#if !defined(__SANITIZE_THREAD__)  // a visit takes several times as long
        CHECK_THAT(usage.output, !Contains("could not be checked"));
#endif
        CHECK(usage.most_threads > 32);  // several domains at once
        CHECK(usage.most_threads < 200);
        CHECK(usage.most_files < 1024);
        CHECK(usage.took_s < 15);
      }
    }
    WHEN("it may open 40 files") {
      const SearchUsage usage = search(empty.domain_id(), 40);
      CAPTURE(usage.output, usage.took_s, usage.most_threads, usage.most_files);
      THEN("it says what it could not check, within 15 s") {
        CHECK(usage.code == 1);
        CHECK_THAT(usage.output, Contains("could not be checked"));
        CHECK(usage.took_s < 15);
      }
    }
  }
}

SCENARIO("a pause of the doctor loses none of its samples") {
  const Bus bus;
  Consumer<sonopose_FusedPose> poses(bus, topics::pose);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--imu-rate", "250"});
  REQUIRE(poses.wait_for(is_ready));
  Process doctor(SONOPOSE_TEST_DOCTOR, {"--domain", std::to_string(bus.domain_id()), "--duration", "6"},
                 neutral);
  CHECK_FALSE(doctor.wait_for_exit(std::chrono::milliseconds(2000)));
  doctor.send(SIGSTOP);
  CHECK_FALSE(doctor.wait_for_exit(std::chrono::milliseconds(1200)));
  doctor.send(SIGCONT);
  REQUIRE(doctor.wait_for_exit());
  const std::string output = doctor.text(Stream::output);
  CAPTURE(output);
  CHECK_THAT(output, Contains("beacon 7: IMU 250") || Contains("beacon 7: IMU 249"));
  CHECK_THAT(output, !Contains("not received"));
}

SCENARIO("a look that is stopped says so") {
  const Bus bus;
  Consumer<sonopose_FusedPose> poses(bus, topics::pose);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--scenario", "rest"});
  REQUIRE(poses.wait_for(is_ready));
  Process doctor(SONOPOSE_TEST_DOCTOR, {"--domain", std::to_string(bus.domain_id()), "--duration", "60"},
                 neutral);
  CHECK_FALSE(doctor.wait_for_exit(std::chrono::milliseconds(3000)));
  doctor.send(SIGINT);
  CHECK(doctor.wait_for_exit() == 0);
  CHECK_THAT(doctor.text(Stream::output), Contains("stopped after ") && Contains(" of 60 s: "));
}

SCENARIO("on a terminal, the doctor shows how far it is") {
  const Bus bus;
  const auto bridge = bus.bridge({});
  REQUIRE(bridge->wait_for_line(Stream::error, "found"));
  TerminalProcess doctor(SONOPOSE_TEST_DOCTOR,
                         {"--domain", std::to_string(bus.domain_id()), "--duration", "5"});
  CHECK(doctor.wait_for("observing the system"));
  CHECK(doctor.wait_for("###"));
  REQUIRE(doctor.wait_for_exit());
  CHECK_THAT(doctor.screen().text(), Contains("no fusion runs") && !Contains("observing the system"));
}

SCENARIO("the doctor refuses an invalid command line") {
  const Bus bus;
  CHECK(doctor(bus.domain_id(), {"--duration", "0"}).code.value_or(0) > 1);
  CHECK(doctor(bus.domain_id(), {"--nonsense"}).code.value_or(0) > 1);
}

}  // namespace doctor_test
