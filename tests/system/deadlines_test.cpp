/// Missed deadlines, lost writers, partitions, and beacons shared between fusions.

#include "support/pose_tap.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::deadlines_test {

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
    WHEN("the chain runs until several predicted poses follow that of a sample, and the IMU stops") {
      TimeNs sample_ns = 0;
      int predicted = 0;
      REQUIRE(tap.wait_for(
          [&](const TappedPose& tapped) {
            if (std::exchange(sample_ns, tapped.pose.imu_sensor_time_ns) != sample_ns) predicted = 0;
            return is_predicted(tapped.pose) && ++predicted == 3;
          },
          0));
      bridge->send(SIGSTOP);
      REQUIRE(status.wait_for([](const FusionStatus& latest) { return latest.imu_silent; },
                              status.samples.size()));
      bridge->send(SIGCONT);
      REQUIRE(status.wait_for([](const FusionStatus& latest) { return !latest.imu_silent; },
                              status.samples.size()));
      THEN("the status has reported it, and nothing was predicted after the deadline") {
        for (const TappedPose& tapped : tap.since(0)) {
          if (!is_predicted(tapped.pose)) continue;
          REQUIRE(tapped.pose.time_ns > tapped.pose.imu_sensor_time_ns);
          REQUIRE(tapped.pose.time_ns - tapped.pose.imu_sensor_time_ns < imu_deadline_ns);
        }
      }
    }
  }
}

/// Next report of the monitor, from line `from`, that fulfils `predicate`; empty after the timeout or 180
/// others.
template <class Predicate>
nlohmann::json wait_for_report(Process& monitor, const Predicate& predicate, std::size_t from = 0) {
  const std::size_t end = from + 180;
  for (; from < end && monitor.wait_for_lines(Stream::output, from + 1); ++from) {
    auto report = nlohmann::json::parse(monitor.lines(Stream::output)[from]);
    if (predicate(report["beacons"])) return report;
  }
  return {};
}

/// Next report of the monitor after it has shown `count` beacons, each with a fusion.
nlohmann::json report_after(Process& monitor, std::size_t count) {
  REQUIRE_FALSE(wait_for_report(monitor, [count](const nlohmann::json& beacons) {
                  return beacons.size() == count &&
                         std::none_of(beacons.begin(), beacons.end(),
                                      [](const auto& beacon) { return beacon["fusions"].empty(); });
                }).empty());
  const std::size_t next = monitor.lines(Stream::output).size();
  return wait_for_report(
      monitor, [](const auto&) { return true; }, next);
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
    WHEN("the bridge stops for longer than its lease") {
      bridge->send(SIGSTOP);
      THEN("the fusion counts the missed deadlines of the IMU and the loss of the bridge") {
        REQUIRE(status.wait_for([](const FusionStatus& latest) {
          return latest.imu_silent && latest.bridge_losses >= 1 && latest.imu_deadlines_missed >= 5;
        }));
        REQUIRE(monitor->wait_for_line(Stream::error, "beacon 7: no pose for"));
        AND_WHEN("it continues") {
          bridge->send(SIGCONT);
          THEN("it counts its own missed deadlines; the monitor counts those of both, and the poses resume") {
            CHECK(
                beacon.wait_for([](const BeaconStatus& latest) { return latest.imu_deadlines_missed >= 5; }));
            CHECK(monitor->wait_for_line(Stream::error, "beacon 7: poses arrive again, after"));
            CHECK_FALSE(wait_for_report(*monitor, [](const nlohmann::json& beacons) {
                          return beacons[0]["pose_deadlines_missed"].get<int>() >= 5 &&
                                 beacons[0]["fusion"]["imu_deadlines_missed"].get<int>() >= 5;
                        }).empty());
            AND_WHEN("the fusion is killed") {
              fusion->send(SIGKILL);
              THEN("the monitor reports the loss of the pose stream") {
                CHECK_FALSE(wait_for_report(*monitor, [](const nlohmann::json& beacons) {
                              return beacons[0]["lost"] == true && beacons[0]["pose_losses"].get<int>() >= 1;
                            }).empty());
              }
            }
          }
        }
      }
    }
  }
}

SCENARIO("a beacon that falls silent is reported while the poses of another one flow") {
  GIVEN("two beacons of two bridges") {
    const Bus bus;
    const PoseTap tap(bus);
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
      std::vector<std::ptrdiff_t> meanwhile;  // poses of the other beacon, ten per deadline
      for (int i = 0; i < 5; ++i) {
        bridge->send(SIGSTOP);
        REQUIRE(wait_for_silence(true));
        const TimeNs reported_ns = status.samples.back().time_ns;
        REQUIRE(tap.wait_for(
            [&](const TappedPose& tapped) {
              return tapped.pose.address == 8 && tapped.pose.fusion_in_time_ns > reported_ns;
            },
            0));
        TimeNs latest_ns = 0;
        const auto poses = tap.since(0);
        for (const TappedPose& tapped : poses) {
          if (tapped.pose.address == 7) latest_ns = tapped.pose.fusion_in_time_ns;
        }
        meanwhile.push_back(std::count_if(poses.begin(), poses.end(), [&](const TappedPose& tapped) {
          const TimeNs taken_ns = tapped.pose.fusion_in_time_ns;
          return tapped.pose.address == 8 && taken_ns > latest_ns && taken_ns < reported_ns;
        }));
        bridge->send(SIGCONT);
        REQUIRE(wait_for_silence(false));
      }
      THEN("its status follows the deadline at once, not with the next periodic one") {
        std::sort(meanwhile.begin(), meanwhile.end());
        CAPTURE(meanwhile);
        CHECK(meanwhile[2] <= 30);
      }
    }
  }
}

/// Number of times that the main thread of a process has slept.
long sleeps_of_main_thread(int pid) {
  std::ifstream status(fmt::format("/proc/{0}/task/{0}/status", pid));
  const std::string key = "voluntary_ctxt_switches:";
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::stol(line.substr(key.size()));
  }
  FAIL("no context switches of " << pid);
  return 0;
}

/// Time within one second after any pose that was 20 ms later than usual, from index `first`. The fusion then
/// watches for an overload.
double watchful_s(const std::vector<TappedPose>& poses, std::size_t first) {
  const auto age_ns = [](const TappedPose& tapped) {
    return tapped.pose.fusion_out_time_ns - tapped.pose.imu_bridge_time_ns;
  };
  const TimeNs min_ns = age_ns(*std::min_element(
      poses.begin(), poses.end(), [&](const auto& a, const auto& b) { return age_ns(a) < age_ns(b); }));
  TimeNs sum_ns = 0;
  TimeNs late_ns = poses.front().pose.fusion_out_time_ns;  // counts the first poses as late
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const TimeNs now_ns = poses[i].pose.fusion_out_time_ns;
    if (age_ns(poses[i]) - min_ns > 15'000'000) late_ns = now_ns;
    if (i >= first && now_ns - late_ns < 1'000'000'000)
      sum_ns += now_ns - poses[i - 1].pose.fusion_out_time_ns;
  }
  return seconds_between(0, sum_ns);
}

SCENARIO("while poses flow, the main thread of the fusion sleeps") {
  GIVEN("a fusion that serves a beacon") {
    const Bus bus;
    const PoseTap tap(bus);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(tap.wait_for_count(0, 150).size() >= 150);
    WHEN("two seconds pass") {
      const std::size_t first = tap.count();
      const long before = sleeps_of_main_thread(fusion->pid());
      REQUIRE(tap.wait_for_count(first, 200).size() >= 200);
      const long sleeps = sleeps_of_main_thread(fusion->pid()) - before;
      THEN("it wakes half as often as one that wakes in each half of a lease, except after late poses") {
        const double watched_s = watchful_s(tap.since(0), first);
        const auto poses = tap.since(first);
        const double passed_s =
            seconds_between(poses.front().pose.fusion_out_time_ns, poses.back().pose.fusion_out_time_ns);
        CAPTURE(watched_s, passed_s);
        CHECK(static_cast<double>(sleeps) <= 10 * passed_s + 100 * watched_s);
      }
    }
  }
}

SCENARIO("a fusion whose poses stop stays alive") {
  const Bus bus;
  PoseTap tap(bus);
  Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--scenario", "rest"});
  bool kept = false;
  for (int i = 0; i < 15 && !kept; ++i) {  // on a busy machine a lease may end
    REQUIRE(tap.wait_for_count(tap.count(), 20).size() >= 20);
    const SteadyTime stopped = clocks::steady_now();
    bridge->send(SIGSTOP);
    REQUIRE(
        status.wait_for([](const FusionStatus& latest) { return latest.imu_silent; }, status.samples.size()));
    for (int later = 0; later < 2; ++later) {  // one second apart
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
      report_after(*both, 2);
      const auto report = report_after(*one, 1);
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
      const auto report = report_after(*monitor, 4);
      REQUIRE(report["beacons"].size() == 4);
      for (const auto& beacon : report["beacons"]) CHECK(beacon["fusions"].size() == 1);
    }
  }
}

}  // namespace sonopose::deadlines_test
