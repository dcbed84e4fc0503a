/// Missed deadlines, lost writers, partitions and shares of the beacons.

#include "support/pose_tap.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

namespace deadlines_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

bool is_predicted(const FusedPose& pose) {
  return (pose.status & status_predicted) != 0U;
}

constexpr TimeNs imu_deadline_ns = 100'000'000;

SCENARIO("poses are predicted between IMU samples, and only until the IMU's deadline") {
  GIVEN("an IMU at 100 Hz and an output rate of 500 Hz") {
    const Bus bus;
    PoseTap tap(bus);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const std::string engine = GENERATE("documented", "kalman");
    CAPTURE(engine);
    const auto fusion = bus.fusion({"--set", "output.rate_hz=500", "--set", "fusion.engine=" + engine});
    const auto bridge = bus.bridge({});
    REQUIRE(tap.wait_for([](const TappedPose& tapped) { return is_predicted(tapped.pose); }, 0));
    WHEN("the chain runs") {
      const auto poses = tap.wait_for_count(tap.count(), 600);
      THEN("several predicted poses follow the pose of each sample") {
        std::size_t predicted = 0;
        for (const TappedPose& tapped : poses) {
          if (!is_predicted(tapped.pose)) continue;
          ++predicted;
          REQUIRE(tapped.pose.time_ns > tapped.pose.imu_sensor_time_ns);
          REQUIRE(tapped.pose.time_ns - tapped.pose.imu_sensor_time_ns < imu_deadline_ns);
        }
        const double share = static_cast<double>(predicted) / static_cast<double>(poses.size());
        CHECK(share == Approx(5.0 / 6.0).margin(0.25));
      }
    }
    WHEN("the IMU stops") {
      bridge->send(SIGSTOP);
      THEN("the status reports it, and prediction ends at the deadline") {
        REQUIRE(status.wait_for([](const FusionStatus& latest) { return latest.imu_silent; },
                                status.samples.size()));
        const auto all = tap.since(0);
        const FusedPose& last = all.back().pose;
        CHECK(last.time_ns - last.imu_sensor_time_ns < imu_deadline_ns);
        const std::size_t count = tap.count();
        bridge->send(SIGCONT);
        REQUIRE(status.wait_for([](const FusionStatus& latest) { return !latest.imu_silent; },
                                status.samples.size()));
        const auto next = tap.wait_for([](const TappedPose&) { return true; }, count);
        REQUIRE(next);
        CHECK_FALSE(is_predicted(next->pose));  // nothing was predicted during the silence
      }
    }
  }
}

SCENARIO("missed deadlines and lost bridges are counted where they are detected") {
  GIVEN("a chain with a monitor") {
    const Bus bus;
    PoseTap tap(bus);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    Consumer<sonopose_BeaconStatus> beacon(bus, topics::beacon_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    const auto monitor = bus.monitor({"--json"});
    REQUIRE(tap.wait_for_count(0, 50).size() >= 50);
    REQUIRE(monitor->wait_for_lines(Stream::output, 1));
    WHEN("the bridge stops for longer than its lease and continues") {
      bridge->send(SIGSTOP);
      REQUIRE(status.wait_for([](const FusionStatus& latest) { return latest.bridge_losses >= 1; }));
      REQUIRE(monitor->wait_for_line(Stream::error, "beacon 7: no pose for"));
      bridge->send(SIGCONT);
      THEN("the fusion counts the missed deadlines of the IMU and the loss of the bridge") {
        CHECK(status.samples.back().imu_deadlines_missed >= 5);
        CHECK(status.samples.back().imu_silent);
      }
      THEN("the bridge counts its own missed deadlines") {
        REQUIRE(beacon.wait_for([](const BeaconStatus& latest) { return latest.imu_deadlines_missed >= 5; }));
      }
      THEN("the monitor counts the missed deadlines of the poses, and reports when poses resume") {
        REQUIRE(monitor->wait_for_line(Stream::error, "beacon 7: poses again, after"));
        REQUIRE(monitor->wait_for_lines(Stream::output, monitor->lines(Stream::output).size() + 1));
        const auto report = nlohmann::json::parse(monitor->lines(Stream::output).back());
        CHECK(report["beacons"][0]["pose_deadlines_missed"].get<int>() >= 5);
        CHECK(report["beacons"][0]["fusion"]["imu_deadlines_missed"].get<int>() >= 5);
      }
    }
    WHEN("the fusion is killed") {
      fusion->send(SIGKILL);
      THEN("the monitor reports the loss of the pose stream") {
        REQUIRE(monitor->wait_for_line(Stream::error, "beacon 7: no pose for"));
        const std::size_t lines = monitor->lines(Stream::output).size();
        REQUIRE(monitor->wait_for_lines(Stream::output, lines + 2));
        const auto report = nlohmann::json::parse(monitor->lines(Stream::output).back());
        CHECK(report["beacons"][0]["lost"] == true);
        CHECK(report["beacons"][0]["pose_losses"].get<int>() >= 1);
      }
    }
  }
}

SCENARIO("a consumer detects the death of a fusion within a lease") {
  constexpr double lease_ms = 100.0;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr double slowness = 5.0;
#else
  constexpr double slowness = 1.5;  // a busy machine
#endif
  const Bus bus;
  PoseTap tap(bus);
  const auto bridge = bus.bridge({"--scenario", "rest"});
  std::vector<double> waits_ms;
  for (int i = 0; i < 5; ++i) {
    const auto fusion = bus.fusion();
    REQUIRE(tap.wait_for_count(tap.count(), 20).size() >= 20);
    const SteadyTime killed = clocks::steady_now();
    fusion->send(SIGKILL);
    const auto lost = tap.wait_for_loss(killed);
    REQUIRE(lost);
    waits_ms.push_back(static_cast<double>(*lost - killed) * 1e-6);
  }
  std::sort(waits_ms.begin(), waits_ms.end());
  CAPTURE(waits_ms);
  CHECK(waits_ms[2] <= slowness * lease_ms);
}

SCENARIO("a beacon that falls silent is reported while the poses of another one flow") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr double slowness = 5.0;
#else
  constexpr double slowness = 2.0;  // a busy machine
#endif
  GIVEN("two beacons of two bridges") {
    const Bus bus;
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto steady = bus.bridge({"--scenario", "rest", "--address", "8"});
    const auto bridge = bus.bridge({"--scenario", "rest", "--address", "7"});
    const auto wait_for_silence = [&](bool silent) {
      return status.wait_for(
          [=](const FusionStatus& latest) { return latest.address == 7 && latest.imu_silent == silent; },
          status.samples.size());
    };
    REQUIRE(wait_for_silence(false));
    WHEN("one of the bridges stops, several times") {
      std::vector<double> waits_ms;
      for (int i = 0; i < 7; ++i) {
        const SteadyTime stopped = clocks::steady_now();
        bridge->send(SIGSTOP);
        REQUIRE(wait_for_silence(true));
        waits_ms.push_back(static_cast<double>(clocks::steady_now() - stopped) * 1e-6);
        bridge->send(SIGCONT);
        REQUIRE(wait_for_silence(false));
      }
      THEN("its status follows the deadline at once, not with the next periodic one") {
        std::sort(waits_ms.begin(), waits_ms.end());
        CAPTURE(waits_ms);
        CHECK(waits_ms[3] <= slowness * 150.0);
      }
    }
  }
}

/// How often the main thread of a process has slept.
long sleeps_of_main_thread(int pid) {
  std::ifstream status(fmt::format("/proc/{0}/task/{0}/status", pid));
  const std::string key = "voluntary_ctxt_switches:";
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::stol(line.substr(key.size()));
  }
  FAIL("no context switches of " << pid);
  return 0;
}

SCENARIO("while poses flow, the main thread of the fusion sleeps") {
  const Bus bus;
  PoseTap tap(bus);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--scenario", "rest"});
  REQUIRE(tap.wait_for_count(tap.count(), 100).size() >= 100);
  constexpr long few = 11;  // half of those of a thread that wakes in each half of a lease
  long least = std::numeric_limits<long>::max();
  for (int i = 0; i < 30 && least > few; ++i) {  // for a second after a late pose, it wakes
    const long before = sleeps_of_main_thread(fusion->pid());
    REQUIRE(tap.wait_for_count(tap.count(), 100).size() >= 100);
    least = std::min(least, sleeps_of_main_thread(fusion->pid()) - before);
  }
  CHECK(least <= few);
}

SCENARIO("a fusion whose poses stop stays alive") {
  const Bus bus;
  PoseTap tap(bus);
  Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--scenario", "rest"});
  bool kept = false;
  for (int i = 0; i < 5 && !kept; ++i) {  // on a busy machine a lease may end
    REQUIRE(tap.wait_for_count(tap.count(), 20).size() >= 20);
    const SteadyTime stopped = clocks::steady_now();
    bridge->send(SIGSTOP);
    REQUIRE(
        status.wait_for([](const FusionStatus& latest) { return latest.imu_silent; }, status.samples.size()));
    for (int later = 0; later < 2; ++later) {  // a second between the two
      REQUIRE(status.wait_for([](const FusionStatus&) { return true; }, status.samples.size()));
    }
    kept = !tap.has_loss(stopped);
    bridge->send(SIGCONT);
  }
  CHECK(kept);
}

SCENARIO("partitions are isolated, and a pattern matches several partitions") {
  GIVEN("a chain in each of two partitions") {
    const Bus bus;
    const auto east = bus.fusion({"--partition", "hall-east"});
    const auto west = bus.fusion({"--partition", "hall-west"});
    const auto east_bridge = bus.bridge({"--partition", "hall-east", "--address", "7"});
    const auto west_bridge = bus.bridge({"--partition", "hall-west", "--address", "8"});
    const auto both = bus.monitor({"--json", "--partition", "hall-*"});
    const auto one = bus.monitor({"--json", "--partition", "hall-east"});
    THEN("a consumer of one partition receives one beacon, a consumer of both receives both") {
      REQUIRE(both->wait_for_line(Stream::output, "\"address\":8"));
      REQUIRE(both->wait_for_line(Stream::output, "\"address\":7"));
      REQUIRE(one->wait_for_lines(Stream::output, 3));
      const auto report = nlohmann::json::parse(one->lines(Stream::output).back());
      REQUIRE(report["beacons"].size() == 1);
      CHECK(report["beacons"][0]["address"] == 7);
      CHECK(report["beacons"][0]["fusions"].size() == 1);
    }
  }
}

SCENARIO("two fusions share the beacons by address") {
  GIVEN("four beacons, and two fusions with two of them each") {
    const Bus bus;
    const auto low = bus.fusion({"--addresses", "20-21"});
    const auto high = bus.fusion({"--addresses", "22-23"});
    const auto bridge = bus.bridge({"--beacons", "4", "--address", "20"});
    const auto monitor = bus.monitor({"--json"});
    THEN("each beacon has one fusion") {
      REQUIRE(monitor->wait_for_line(Stream::output, "\"address\":23"));
      REQUIRE(monitor->wait_for_lines(Stream::output, monitor->lines(Stream::output).size() + 2));
      const auto report = nlohmann::json::parse(monitor->lines(Stream::output).back());
      REQUIRE(report["beacons"].size() == 4);
      for (const auto& beacon : report["beacons"]) CHECK(beacon["fusions"].size() == 1);
    }
  }
}

}  // namespace deadlines_test
