/// The doctor on healthy systems, and on systems with one fault.

#include "doctor/probe/survey.hpp"
#include "support/bus.hpp"
#include "support/terminal_process.hpp"
#include "support/wait_until.hpp"
#include "system/doctor_run.hpp"
#include <sonopose/dds/psm/discovery.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <random>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace sonopose::doctor_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

bool is_ready(const FusedPose& pose) {
  constexpr std::uint32_t not_yet = status_initialising | status_uncalibrated | status_heading_unknown;
  return (pose.status & not_yet) == 0U;
}

/// Reports of the doctor on one chain: unchanged, with more processes, and without its fusion.
struct Looks {
  std::uint32_t domain_id = 0;
  int fusion = 0, bridge = 0, second_bridge = 0;  ///< ids of the processes
  Result healthy, json, stopped, paused, disturbed, without_fusion;
};

/// Waits until `count` doctors listen.
void wait_for_doctors(const Bus& bus, std::ptrdiff_t count) {
  const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
  const dds::Discovery discovery(participant);
  REQUIRE(wait_until([&] {
    const auto readers = discovery.readers();
    return std::count_if(readers.begin(), readers.end(), [](const dds::FoundEndpoint& reader) {
             return reader.topic_name == topics::report.name;
           }) >= count;
  }));
}

Looks look_at_chain() {
  const Bus bus;
  Looks looks;
  looks.domain_id = bus.domain_id();
  Consumer<sonopose_FusedPose> poses(bus, topics::pose);
  Consumer<sonopose_ImuSample> imu(bus, topics::imu);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--imu-rate", "250"});
  looks.fusion = fusion->pid();
  looks.bridge = bridge->pid();
  REQUIRE(poses.wait_for(is_ready));

  const auto stopped = start_doctor(bus.domain_id(), {"--duration", "60"});
  std::unique_ptr<Process> paused;
  do {  // on a busy machine, its 2 s may be over before the pause
    paused = start_doctor(bus.domain_id(), {"--duration", "2"});
    wait_for_doctors(bus, 2);
    imu.take();
    REQUIRE(imu.wait_for_more(150));
    paused->send(SIGSTOP);
    imu.take();
    REQUIRE(imu.wait_for_more(300));
  } while (paused->wait_for_exit(std::chrono::milliseconds(0)));
  paused->send(SIGCONT);
  looks.paused = result_of(*paused);
  stopped->send(SIGINT);
  looks.stopped = result_of(*stopped);

  looks.healthy = look_for("no problems found", bus.domain_id(), {"--duration", "1"});
  looks.json = look_for(R"("ok":true)", bus.domain_id(), {"--json", "--duration", "0.5"});

  const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
  const dds::topic::Topic<sonopose_FusedPose> topic(participant, topics::pose.name);
  const dds::sub::DataReader<sonopose_FusedPose> shared(dds::sub::Subscriber(participant), topic);
  const auto second = bus.bridge({});
  looks.second_bridge = second->pid();
  REQUIRE(second->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
  looks.disturbed = look_for("2 bridges publish it", bus.domain_id(), {"--duration", "1"});
  second->end_by(SIGINT);

  REQUIRE(fusion->end_by(SIGINT).code == 0);
  looks.without_fusion = look_for("beacon 7: IMU ", bus.domain_id(), {"--duration", "0.5"});
  return looks;
}

SCENARIO("the doctor reports what is wrong with a running system, or that nothing is") {
  static const Looks looks = look_at_chain();
  const auto process = [](int pid) { return "(process " + std::to_string(pid) + " on "; };
  GIVEN("a bridge, a fusion and a consumer") {
    THEN("it reports no problem, and the rates") {
      CAPTURE(looks.healthy.output, looks.healthy.error);
      CHECK(looks.healthy.code == 0);
      CHECK_THAT(looks.healthy.output, Contains("no problems found") && Contains("beacon 7: IMU "));
      CHECK_THAT(looks.healthy.output, Contains("domain " + std::to_string(looks.domain_id)));
    }
    THEN("its JSON is one object") {
      const auto report = nlohmann::json::parse(looks.json.output);
      CHECK(report["ok"] == true);
      CHECK(report["findings"].size() >= 2);
    }
    THEN("a pause of the doctor loses none of its samples") {
      CAPTURE(looks.paused.output, looks.paused.error);
      CHECK_THAT(looks.paused.output, Contains("beacon 7: IMU ") && !Contains("not received"));
    }
    THEN("a look that is stopped says so in a note") {
      CHECK_THAT(looks.stopped.output, Contains("note     doctor: stopped after ") && Contains(" of 60 s: "));
    }
  }
  GIVEN("a consumer that requests shared ownership, too") {
    THEN("it is named, with the policy and the remedy") {
      const std::string& output = looks.disturbed.output;
      CAPTURE(output, looks.disturbed.error);
      CHECK(looks.disturbed.code == 1);
      CHECK_THAT(output, Contains("test_system_doctor " + process(::getpid())));
      CHECK_THAT(output,
                 Contains("cannot receive from") && Contains("sonopose-fusion " + process(looks.fusion)));
      CHECK_THAT(output, Contains("ownership: offered exclusive, requested shared"));
    }
  }
  GIVEN("a second bridge that publishes the same beacon") {
    THEN("both are reported") {
      CAPTURE(looks.disturbed.output);
      CHECK_THAT(looks.disturbed.output, Contains("beacon 7: 2 bridges publish it") &&
                                             Contains(process(looks.bridge)) &&
                                             Contains(process(looks.second_bridge)));
    }
  }
  GIVEN("a bridge whose fusion has ended") {
    THEN("the doctor reports that it is missing, and that the beacon is published") {
      CAPTURE(looks.without_fusion.output, looks.without_fusion.error);
      CHECK(looks.without_fusion.code == 1);
      // The remedy depends on other processes on this machine.
      CHECK_THAT(looks.without_fusion.output,
                 Contains("no fusion runs in domain " + std::to_string(looks.domain_id)) &&
                     !Contains("no bridge publishes"));
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
      const Result result = look_for("along -y", bus.domain_id(), {"--duration", "1"});
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
  GIVEN("an empty domain, and a bridge in another one") {
    const Bus empty;
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = bus.bridge({});
    REQUIRE(imu.wait_for_count(1));
    WHEN("the doctor checks the empty one") {
      const std::string used = std::to_string(bus.domain_id());
      const std::string remedy = "beacons are published in domain " + used + ": use --domain " + used;
      const Result result = look_for(remedy, empty.domain_id(), {"--duration", "0.5"});
      THEN("it reports an error, and names the correct domain") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("no sonopose process in domain " + std::to_string(empty.domain_id())) &&
                       Contains(remedy));
      }
    }
  }
}

/// UDP ports in use, each of a different domain.
class OccupiedDomains {
public:
  OccupiedDomains(unsigned first, unsigned last) {
    for (unsigned id = first; id <= last; ++id) {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port =
          htons(static_cast<std::uint16_t>(7400 + 250 * id + 100));  // unlikely to be used by another process
      const int file = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      REQUIRE(file >= 0);
      files_.push_back(file);
      const bool bound = ::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
      REQUIRE((bound || errno == EADDRINUSE));  // another process's socket serves as well
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

/// Exit code of a search of all domains, and the resources that it used.
struct SearchUsage {
  std::optional<int> code;
  std::size_t max_threads = 0;
  std::size_t max_files = 0;
};

SearchUsage search(std::uint32_t domain_id) {
  const auto process = start_doctor(domain_id, {"--duration", "0.5"});
  const std::filesystem::path folder = "/proc/" + std::to_string(process->pid());
  SearchUsage usage;
  wait_until([&] {
    usage.max_threads = std::max(usage.max_threads, entries_of(folder / "task"));
    usage.max_files = std::max(usage.max_files, entries_of(folder / "fd"));
    usage.code = process->wait_for_exit(std::chrono::milliseconds(5));
    return usage.code.has_value();
  });
  return usage;
}

/// Limits the number of files that this process may open during its lifetime.
class FileLimit {
public:
  explicit FileLimit(rlim_t most) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit now = before_;
    now.rlim_cur = most;
    REQUIRE(::setrlimit(RLIMIT_NOFILE, &now) == 0);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;
  ~FileLimit() { ::setrlimit(RLIMIT_NOFILE, &before_); }

private:
  rlimit before_{};
};

SCENARIO("the doctor's search of all domains is bounded") {
  GIVEN("an empty domain, and programs in 48 others, which are visited 32 at a time") {
    const Bus empty;
    const OccupiedDomains others(185, 232);
    WHEN("a bridge runs in any of them") {
      std::random_device random;
      const auto used = std::to_string(std::uniform_int_distribution<unsigned>(185, 232)(random));
      CAPTURE(used);
      Process bridge(SONOPOSE_TEST_BRIDGE, {"--scenario", "rest", "--domain", used}, neutral);
      REQUIRE(bridge.wait_for_line(Stream::error, "found"));
      doctor::rules::BusObservation bus;
      constexpr TimeNs max_duration_ns = 120'000'000'000;  // on a busy machine a visit takes long
      doctor::probe::search_other_domains({.domain_id = empty.domain_id()}, process::StopSignal(), bus,
                                          max_duration_ns);
      THEN("the search finds it") {
        CHECK(bus.domains_not_searched == 0);
        CHECK(std::ranges::any_of(bus.other_domains, [&](const doctor::rules::DomainObservation& domain) {
          return std::to_string(domain.id) == used && domain.beacons;
        }));
      }
    }
    WHEN("the doctor visits them") {
      const SearchUsage usage = search(empty.domain_id());
      THEN("it has several at once, with less than 200 threads and 1024 files") {
        CHECK(usage.code == 1);
        CHECK(usage.max_threads > 32);
        CHECK(usage.max_threads < 200);
        CHECK(usage.max_files < 1024);
      }
    }
    const process::StopSignal stop;
    const auto not_searched = [&](TimeNs max_duration_ns) {
      doctor::rules::BusObservation bus;
      doctor::probe::search_other_domains({.domain_id = empty.domain_id()}, stop, bus, max_duration_ns);
      return bus.domains_not_searched;
    };
    WHEN("the time is over after the first visits") {
      const std::size_t count = not_searched(300'000'000);  // duration of a visit
      THEN("the other domains are counted") {
        CHECK(count >= 48 - 32);
      }
    }
    WHEN("the files suffice for none") {
      const FileLimit limit(entries_of("/proc/self/fd") + 5);
      const std::size_t count = not_searched(60'000'000'000);
      THEN("all are counted") {
        CHECK(count >= 48);
      }
    }
  }
}

SCENARIO("on a terminal, the doctor shows how far it is") {
  GIVEN("a bridge, and a doctor on a terminal") {
    const Bus bus;
    const auto bridge = bus.bridge({});
    REQUIRE(bridge->wait_for_line(Stream::error, "found"));
    // The bar is drawn after 2 s.
    TerminalProcess doctor(SONOPOSE_TEST_DOCTOR,
                           {"--domain", std::to_string(bus.domain_id()), "--duration", "20"});
    THEN("a bar grows, and gives way to the report when the user stops it") {
      CHECK(doctor.wait_for("observing the system"));
      CHECK(doctor.wait_for("###"));
      doctor.type("\x03");
      REQUIRE(doctor.wait_for_exit());
      CHECK_THAT(doctor.screen().text(), Contains("no fusion runs") && !Contains("observing the system"));
    }
  }
}

SCENARIO("the doctor refuses an invalid command line") {
  const Bus bus;
  CHECK(look(bus.domain_id(), {"--duration", "0"}).code.value_or(0) > 1);
  CHECK(look(bus.domain_id(), {"--nonsense"}).code.value_or(0) > 1);
}

}  // namespace sonopose::doctor_test
