/// Recordings of published samples, and captures of raw bytes.

#include "recording/log_folder.hpp"
#include "recording/log_meta.hpp"
#include "support/bus.hpp"
#include "support/events.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fcntl.h>
#include <map>
#include <sys/stat.h>
#include <unistd.h>

namespace sonopose::recording_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Consumers of the three native input streams.
struct Streams {
  explicit Streams(const Bus& bus)
      : imu(bus, topics::imu), fixes(bus, topics::fix), headings(bus, topics::heading) {}

  /// All published events by sequence number.
  std::map<std::uint64_t, Event> events() {
    imu.take();
    fixes.take();
    headings.take();
    std::map<std::uint64_t, Event> events;
    for (const auto& sample : imu.samples) events[sample.sequence] = sample;
    for (const auto& sample : fixes.samples) events[sample.sequence] = sample;
    for (const auto& sample : headings.samples) events[sample.sequence] = sample;
    return events;
  }

  Consumer<sonopose_ImuSample> imu;
  Consumer<sonopose_UltrasonicFix> fixes;
  Consumer<sonopose_PairHeading> headings;
};

/// Clears the fields that the format lacks: publication time and fix flags.
Event as_recorded(Event event) {
  if (auto* imu = std::get_if<ImuSample>(&event)) imu->bridge_time_ns = 0;
  if (auto* fix = std::get_if<UltrasonicFix>(&event)) fix->flags = 0;
  return event;
}

/// Range of the difference `a − b`, ns: the difference of two clocks without their offset.
template <class Sample, class TimeOf>
TimeNs time_spread_ns(const std::vector<Sample>& a, const std::vector<Sample>& b, const TimeOf& time_of) {
  TimeNs least = INT64_MAX;
  TimeNs greatest = INT64_MIN;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const TimeNs difference_ns = time_of(a[k]) - time_of(b[k]);
    least = std::min(least, difference_ns);
    greatest = std::max(greatest, difference_ns);
  }
  return greatest - least;
}

SCENARIO("a recording of a live run contains what was published") {
  GIVEN("a bridge that plays and records the simulator at twice real time until each stream was received") {
    const Bus bus;
    const TemporaryFolder folder;
    Streams published(bus);
    const auto bridge = bus.bridge({"--rate", "2", "--record", (folder / "log").string()});
    REQUIRE(published.imu.wait_for_count(100));
    REQUIRE(published.fixes.wait_for_count(10));
    REQUIRE(published.headings.wait_for_count(10));
    REQUIRE(bridge->end_by(SIGINT).code == 0);
    WHEN("the recording is read") {
      const auto log = recording::read_sensor_log(folder / "log");
      THEN("it contains every event of the run, and the received events are equal") {
        CHECK(log.truth.size() == test::samples_of<ImuSample>(log.events).size());
        std::map<std::uint64_t, Event> events;
        REQUIRE(wait_until([&] {
          events = published.events();
          return events.rbegin()->first == log.events.size();
        }));
        const std::uint64_t matched =
            std::max({published.imu.samples.front().sequence, published.fixes.samples.front().sequence,
                      published.headings.samples.front().sequence});
        CHECK(std::distance(events.find(matched), events.end()) ==
              static_cast<std::ptrdiff_t>(log.events.size() + 1 - matched));
        for (const auto& [number, event] : events) {
          CAPTURE(number, event.index());
          REQUIRE(log.events[number - 1] == as_recorded(event));
        }
      }
    }
  }
}

SCENARIO("a raw capture of the simulated beacon gives its samples up to the resolution of the protocol") {
  GIVEN("ten seconds of the simulator as a recording and as raw bytes") {
    const Bus bus;
    const TemporaryFolder folder;
    const std::string bytes = (folder / "bytes.bin").string();
    REQUIRE(bus.bridge({"--rate", "0", "--duration", "10", "--record", (folder / "sent").string(),
                        "--capture", bytes})
                ->wait_for_exit() == 0);
    WHEN("a bridge plays the bytes and records the result") {
      Streams listeners(bus);
      REQUIRE(bus.bridge({"--source", "stream", "--input", bytes, "--rate", "0", "--record",
                          (folder / "received").string()})
                  ->wait_for_exit() == 0);
      const auto sent = recording::read_sensor_log(folder / "sent").events;
      const auto received = recording::read_sensor_log(folder / "received").events;
      THEN("IMU samples agree within half a step of 1 mg and 0.0175 deg/s, stamps within 1 ms") {
        const auto before = test::samples_of<ImuSample>(sent);
        const auto after = test::samples_of<ImuSample>(received);
        REQUIRE(after.size() == before.size());
        REQUIRE(after.size() == 1000);
        for (std::size_t k = 0; k < after.size(); ++k) {
          const Vector3d force = after[k].specific_force_body_mps2 - before[k].specific_force_body_mps2;
          const Vector3d rate = after[k].angular_velocity_body_radps - before[k].angular_velocity_body_radps;
          REQUIRE(force.cwiseAbs().maxCoeff() <= 0.5 * 9.81e-3);
          REQUIRE(rate.cwiseAbs().maxCoeff() <= 0.5 * 0.0175 * M_PI / 180);
        }
        CHECK(time_spread_ns(after, before, [](const ImuSample& s) { return s.sensor_time_ns; }) <=
              1'000'000);
      }
      THEN("fixes agree within half a millimetre and a percent, stamps within 1 ms, headings within 0.05°") {
        auto fixes_before = test::samples_of<UltrasonicFix>(sent);
        const auto fixes = test::samples_of<UltrasonicFix>(received);
        const auto headings_before = test::samples_of<PairHeading>(sent);
        const auto headings = test::samples_of<PairHeading>(received);
        REQUIRE(fixes.size() == fixes_before.size());
        REQUIRE(headings.size() == fixes.size());
        REQUIRE(fixes.size() >= 78);  // at least 8 Hz
        for (std::size_t k = 0; k < fixes.size(); ++k) {
          const Vector3d moved = fixes[k].position_world_m - fixes_before[k].position_world_m;
          REQUIRE(moved.cwiseAbs().maxCoeff() <= 0.5e-3 + 1e-9);
          REQUIRE(fixes[k].quality_percent == fixes_before[k].quality_percent);
          const double turned = headings[k].heading_world_rad - headings_before[k].heading_world_rad;
          REQUIRE(std::abs(std::remainder(turned, 2 * M_PI)) <= 0.05 * M_PI / 180 + 1e-9);
        }
        CHECK(time_spread_ns(fixes, fixes_before,
                             [](const UltrasonicFix& s) { return s.emission_time_ns; }) <= 1'000'000);
      }
    }
  }
}

/// A bridge whose files cannot exceed this size, as on a full disk.
std::unique_ptr<Process> bridge_on_small_disk(const Bus& bus, std::uint32_t kib, const std::string& options) {
  const std::string limit = "ulimit -f " + std::to_string(kib * 2) + "; ";
  const std::string command = "exec " SONOPOSE_TEST_BRIDGE " --domain " + std::to_string(bus.domain_id());
  return std::make_unique<Process>("/bin/sh", Arguments{"-c", limit + command + " " + options});
}

SCENARIO("a full disk ends the recording and the capture, and the stream goes on") {
#if defined(__SANITIZE_THREAD__)
  WARN("skipped: the thread sanitizer does not run under a limit of the size of files");
  return;
#endif
  GIVEN("a consumer, and a bridge that records and captures on a disk of 16 KiB") {
    const Bus bus;
    const TemporaryFolder folder;
    Streams published(bus);
    Consumer<sonopose_BeaconStatus> status(bus, topics::beacon_status);
    const std::string log = (folder / "log").string();
    const std::string capture = (folder / "bytes.bin").string();
    const auto bridge = bridge_on_small_disk(bus, 16, "--rate 4 --record " + log + " --capture " + capture);
    WHEN("the disk is full") {
      REQUIRE(bridge->wait_for_line(Stream::error,
                                    "the recording has ended: " + log + ".part/beacon_7/imu.csv: "));
      REQUIRE(bridge->wait_for_line(Stream::error, "the capture has ended: " + capture + ": "));
      THEN("every later event is published, and the loss is counted and reported at the end") {
        published.imu.take();
        const std::size_t since = published.imu.samples.size();
        REQUIRE(published.imu.wait_for_more(200));
        CHECK(status.wait_for([](const BeaconStatus& now) { return now.samples_unrecorded > 0; }));
        const auto events = published.events();
        const std::uint64_t first = published.imu.samples[since].sequence;
        const std::uint64_t last = published.imu.samples[since + 199].sequence;
        CHECK(std::distance(events.find(first), events.find(last)) ==
              static_cast<std::ptrdiff_t>(last - first));
        CHECK(bridge->end_by(SIGTERM).code == 1);
        CHECK_THAT(bridge->text(Stream::error), Catch::Contains("lacks") && Catch::Contains(log + ".part"));
        AND_THEN("what was recorded before is complete, in a folder with another name") {
          CHECK_FALSE(exists(folder / "log"));
          const auto recorded = recording::read_sensor_log(folder / "log.part/beacon_7");
          CHECK(test::samples_of<ImuSample>(recorded.events).size() > 50);
        }
      }
    }
  }
}

SCENARIO("a disk that stands still does not keep the bridge alive") {
  GIVEN("a bridge whose capture goes to a pipe that nobody reads") {
    const Bus bus;
    const TemporaryFolder folder;
    const std::string pipe = (folder / "pipe").string();
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    const int reader = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
    REQUIRE(::fcntl(reader, F_SETPIPE_SZ, 4096) == 4096);
    Streams published(bus);
    const auto bridge =
        bus.bridge({"--rate", "10", "--capture", pipe, "--record", (folder / "log").string()});
    REQUIRE(published.imu.wait_for_more(1000));  // about 40 bytes each
    WHEN("it is asked to stop") {
      const auto ending = bridge->end_by(SIGTERM);
      THEN("it ends, with an error that counts the loss, and the recording is whole") {
        CHECK(ending.code == 1);
        CHECK_THAT(bridge->text(Stream::error), Catch::Contains("the capture lacks"));
        CHECK(exists(folder / "log"));
      }
    }
    ::close(reader);
  }
}

SCENARIO("only a recording that was ended looks whole") {
  GIVEN("a bridge that records two beacons") {
    const Bus bus;
    const TemporaryFolder folder;
    Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    const auto bridge = bus.bridge({"--beacons", "2", "--seed", "3", "--record", (folder / "log").string()});
    REQUIRE(fixes.wait_for_count(20));
    WHEN("Ctrl-C ends it") {
      REQUIRE(bridge->end_by(SIGINT).code == 0);
      THEN("each beacon has a folder that names its address, the version and the source") {
        for (const char* const name : {"log/beacon_7", "log/beacon_8"}) {
          const auto meta = recording::read_log_meta(folder / name);
          CHECK(meta.beacon_address == (std::string(name).back() == '7' ? 7 : 8));
          CHECK(meta.program_version == recording::program_version());
          CHECK(meta.settings ==
                recording::LogSettings{
                    {"beacons", "2"}, {"scenario", "walk"}, {"seed", "3"}, {"source", "sim"}});
          CHECK(recording::read_sensor_log(folder / name).events.size() > 50);
        }
      }
    }
    WHEN("it is killed") {
      bridge->end_by(SIGKILL);
      THEN("the folder keeps the name of a part") {
        CHECK_FALSE(exists(folder / "log"));
        CHECK(exists(folder / "log.part/beacon_8/imu.csv"));
      }
    }
  }
}

}  // namespace sonopose::recording_test
