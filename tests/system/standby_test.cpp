/// Hot standby: two fusions with the same inputs.

#include "faults/stall_watch.hpp"
#include "support/held_thread.hpp"
#include "support/pose_tap.hpp"
#include "support/wait_until.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>

namespace standby_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

constexpr TimeNs lease_ns = 100'000'000;
constexpr TimeNs imu_period_ns = 5'000'000;
constexpr BeaconAddress contested = 7;   ///< both fusions have this beacon
constexpr BeaconAddress undisputed = 8;  ///< only the weak fusion has this beacon

/// Number of times that a fusion is taken out; docs/standby.md lists results of more.
int kills() {
  const char* const number = std::getenv("SONOPOSE_KILLS");
  return number == nullptr ? 5 : std::atoi(number);
}

using Writers = std::set<std::uint64_t>;

/// A fusion of the pair, with its writers as matched by the tap.
struct Fusion {
  std::unique_ptr<Process> process;
  Writers writers;
  std::uint64_t claim = 0;  ///< the writer with the ownership strength

  [[nodiscard]] bool wrote(const TappedPose& tapped) const { return writers.contains(tapped.writer); }
};

/// A bus with a bridge, a tap, and fusions on request.
class Pair {
public:
  explicit Pair(const Arguments& source = {"--scenario", "rest", "--imu-rate", "200"})
      : tap(bus), bridge(bus.bridge(source)) {}

  Fusion start(const std::string& strength, const Arguments& further = {"--warm-up", "0.2"}) {
    const Writers before = tap.writers();
    Fusion fusion;
    Arguments arguments{"--standby-strength", strength};
    arguments.insert(arguments.end(), further.begin(), further.end());
    fusion.process = bus.fusion(arguments);
    wait_until([&] {
      fusion.writers = tap.writers();
      for (const auto handle : before) fusion.writers.erase(handle);
      return fusion.writers.size() >= 2;
    });
    REQUIRE(fusion.writers.size() == 2);
    for (const auto writer : fusion.writers) {
      if (tap.strength_of(writer) > 0) fusion.claim = writer;
    }
    return fusion;
  }

  /// Waits until the consumer receives a new pose of this fusion.
  void wait_until_served_by(const Fusion& fusion) {
    REQUIRE(tap.wait_for_writer({fusion.claim}, tap.count()));
  }

  Bus bus;
  PoseTap tap;
  std::unique_ptr<Process> bridge;
};

/// A pair whose stronger fusion has only one of two beacons.
struct UnequalPair : Pair {
  explicit UnequalPair(const std::string& scenario = "rest", const std::string& engine = "kalman")
      : Pair({"--scenario", scenario, "--imu-rate", "200", "--beacons", "2"}),
        quick{"--warm-up", "0.2", "--set", "fusion.engine=" + engine},
        weak(start("100", quick)) {
    start_strong();
  }

  void start_strong() {
    Arguments arguments = quick;
    arguments.insert(arguments.end(), {"--addresses", std::to_string(contested)});
    strong = start("200", arguments);
    wait_until_served_by(strong);
  }

  Arguments quick;
  Fusion weak;
  Fusion strong;
};

/// Takes the strong fusion out several times. Prints the consumer's waits for the weak one, and compares them
/// with the poses that the weak one writes meanwhile of its own, undisturbed beacon.
void check_takeovers(const std::string& what, UnequalPair& pair, int times,
                     const std::function<std::function<void()>()>& take_out) {
  std::vector<double> waits_ms;
  std::vector<std::ptrdiff_t> meanwhile;
  for (int i = 0; i < times; ++i) {
    pair.wait_until_served_by(pair.strong);
    const std::size_t before = pair.tap.count();
    const SteadyTime out = clocks::steady_now();
    const auto bring_back = take_out();
    const auto is_taken_over = [&](const TappedPose& tapped) {
      return tapped.pose.address == contested && pair.weak.wrote(tapped);
    };
    const auto first = pair.tap.wait_for(is_taken_over, before);
    REQUIRE(first);
    waits_ms.push_back(static_cast<double>(first->received - out) * 1e-6);
    const auto poses = pair.tap.since(before);
    meanwhile.push_back(
        std::count_if(poses.begin(), std::find_if(poses.begin(), poses.end(), is_taken_over),
                      [](const TappedPose& tapped) { return tapped.pose.address == undisputed; }));
    bring_back();
  }
  std::sort(waits_ms.begin(), waits_ms.end());
  std::sort(meanwhile.begin(), meanwhile.end());
  std::cout << fmt::format(
      "{}: taken over after {:.1f} / {:.1f} / {:.1f} ms (min/median/max of {}), lease {} ms\n", what,
      waits_ms.front(), waits_ms[waits_ms.size() / 2], waits_ms.back(), times, lease_ns / 1'000'000);
  CHECK(meanwhile[meanwhile.size() / 2] <= 2 * lease_ns / imu_period_ns);
}

SCENARIO("a killed fusion is replaced within its lease, and its consumer learns of its death") {
  // A takeover does not depend on the engine, so one engine is killed less often.
  const auto [engine, times] =
      GENERATE(table<std::string, int>({{"kalman", kills()}, {"documented", (3 * kills() + 4) / 5}}));
  UnequalPair pair("rest", engine);
  check_takeovers("kill -9, " + engine, pair, times, [&]() -> std::function<void()> {
    const SteadyTime killed = clocks::steady_now();
    pair.strong.process->send(SIGKILL);
    return [&pair, killed] {
      CHECK(pair.tap.wait_for_loss(killed));
      pair.strong.process->wait_for_exit();
      pair.start_strong();
    };
  });
}

SCENARIO("a stopped fusion is replaced within its lease, and serves again when it continues") {
  UnequalPair pair;
  check_takeovers("SIGSTOP", pair, kills(), [&]() -> std::function<void()> {
    pair.strong.process->send(SIGSTOP);
    return [&] { pair.strong.process->send(SIGCONT); };
  });
  CHECK(pair.tap.wait_for_writer({pair.strong.claim}, pair.tap.count()));
}

SCENARIO("a fusion whose receive thread hangs is replaced, although its other threads run") {
  UnequalPair pair;
  std::optional<HeldThread> held;
  check_takeovers("a thread that hangs", pair, kills(), [&]() -> std::function<void()> {
    held.emplace(pair.strong.process->pid(), "recv");
    return [&held] { held.reset(); };
  });
  CHECK(pair.tap.wait_for_writer({pair.strong.claim}, pair.tap.count()));
}

/// First half of a stop of one second, by the clock of the stamps: samples sent then are old when the process
/// continues.
struct Stop {
  TimeNs from_ns = 0;
  TimeNs until_ns = 0;
  [[nodiscard]] bool has(TimeNs time_ns) const { return time_ns >= from_ns && time_ns < until_ns; }
};
Stop stop_for_a_second(const Process& process) {
  const TimeNs from_ns = clocks::host_now();
  process.send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  const TimeNs until_ns = clocks::host_now() - 500'000'000;
  process.send(SIGCONT);
  return {from_ns, until_ns};
}

bool is_late(const FusedPose& pose) {
  return (pose.status & status_late) != 0U;
}

SCENARIO("a process that was stopped for a second passes nothing old off as live") {
  GIVEN("a standby that serves meanwhile") {
    UnequalPair pair("walk");
    WHEN("the stronger one continues") {
      const std::size_t before = pair.tap.count();
      const Stop stop = stop_for_a_second(*pair.strong.process);
      REQUIRE(pair.tap.wait_for_writer(pair.weak.writers, before));
      pair.wait_until_served_by(pair.strong);
      THEN("the consumer receives no old pose from it, and its time never goes back") {
        TimeNs latest_ns = 0;
        for (const TappedPose& tapped : pair.tap.since(before)) {
          if (!pair.strong.wrote(tapped)) continue;
          CHECK_FALSE(stop.has(tapped.pose.imu_bridge_time_ns));
          CHECK(tapped.pose.time_ns > latest_ns);
          latest_ns = tapped.pose.time_ns;
        }
      }
    }
  }
  GIVEN("no standby") {
    const Bus bus;
    const PoseTap tap(bus);
    const auto bridge = bus.bridge({"--scenario", "walk"});
    const auto fusion = bus.fusion();
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    REQUIRE(tap.wait_for_count(0, 100).size() >= 100);
    for (const std::string name : {"fusion", "bridge"}) {
      // Samples that wait while the bridge is stopped leave it only when it continues.
      const auto since_ns = name == "fusion" ? &FusedPose::imu_bridge_time_ns : &FusedPose::time_ns;
      WHEN("the " + name + " continues") {
        const std::size_t before = tap.count();
        const Stop stop = stop_for_a_second(name == "fusion" ? *fusion : *bridge);
        REQUIRE(tap.wait_for(
            [&](const TappedPose& tapped) {
              return tapped.pose.*since_ns > stop.until_ns && !is_late(tapped.pose);
            },
            before));
        THEN("its old poses are marked, counted, and nothing else is") {
          std::uint64_t marked = 0;
          for (const TappedPose& tapped : tap.since(before)) {
            const FusedPose& pose = tapped.pose;
            const double in_bridge_s = seconds_between(pose.time_ns, pose.imu_bridge_time_ns);
            const double after_it_s = seconds_between(pose.imu_bridge_time_ns, pose.fusion_out_time_ns);
            CAPTURE(in_bridge_s, after_it_s);
            if (is_late(pose)) ++marked;
            if (stop.has(pose.*since_ns)) CHECK(is_late(pose));
            if (std::max(in_bridge_s, after_it_s) < sonopose_LATE_AFTER) CHECK_FALSE(is_late(pose));
          }
          CHECK(marked > 0);
          CHECK(status.wait_for([&](const FusionStatus& latest) { return latest.poses_late >= marked; }, 0));
        }
      }
    }
  }
}

SCENARIO("while the stronger fusion is alive, the weaker one delivers only what the other does not serve") {
  GIVEN("two beacons, and a pair in which the stronger fusion has one of them") {
    UnequalPair pair;
    const std::size_t begin = pair.tap.count();
    WHEN("it has served for a second") {
      std::size_t served = 0;
      REQUIRE(pair.tap.wait_for(
          [&](const TappedPose& tapped) { return pair.strong.wrote(tapped) && ++served == 200; }, begin));
      const auto poses = pair.tap.since(begin);
      THEN("its beacon has its poses, of later and later samples, and the other one those of the weaker") {
        const TappedPose* latest = nullptr;
        for (const TappedPose& tapped : poses) {
          if (tapped.pose.address == undisputed) {
            REQUIRE(pair.weak.wrote(tapped));
            continue;
          }
          if (latest != nullptr && pair.strong.wrote(*latest)) {
            // If a busy machine starves the stronger fusion for a lease, the weaker one serves legitimately.
            if (pair.weak.wrote(tapped)) {
              REQUIRE(tapped.received - latest->received > lease_ns / 4);
            } else {
              REQUIRE(tapped.pose.time_ns > latest->pose.time_ns);
            }
          }
          latest = &tapped;
        }
      }
    }
  }
}

/// Checks one beacon's poses around the time in which the strong fusion serves it. Each belongs to the next
/// sample, or to the same one again, and is close to the previous one. The processes may be some samples
/// apart, mainly if the machine stalled one of them. `stalls` are disjoint.
void check_hand_overs(std::vector<TappedPose> poses, const Fusion& strong, const Fusion& weak,
                      const std::vector<faults::Interval>& stalls) {
  REQUIRE(weak.wrote(poses.front()));
  REQUIRE(weak.wrote(poses.back()));
  // Start at the last pose before the claim; the start of a process may briefly starve the others.
  const auto claimed = std::find_if(poses.begin(), poses.end(),
                                    [&](const TappedPose& pose) { return pose.writer == strong.claim; });
  REQUIRE(claimed != poses.end());
  poses.erase(poses.begin(), std::prev(claimed));
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TappedPose& a, const TappedPose& b) { return a.pose.time_ns < b.pose.time_ns; });
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const FusedPose& before = poses[k - 1].pose;
    const FusedPose& after = poses[k].pose;
    const TimeNs missing_ns = std::max<TimeNs>(0, after.time_ns - before.time_ns - imu_period_ns);
    INFO("beacon " << after.address << ", event " << before.sequence << " to " << after.sequence);
    if (missing_ns > 1000) {
      constexpr TimeNs watch_period_ns = 10'000'000;  // resolution of the measured stalls
      const TimeNs waited_ns =
          faults::covered_ns(stalls, poses[k].received - 1'000'000'000, poses[k].received + watch_period_ns);
      REQUIRE(waited_ns > 0);
      CHECK(missing_ns <= waited_ns + watch_period_ns);
    }
    // Walking speed of at most 1.3 m/s, plus the difference between the engines (late_starter_test).
    CHECK((after.position_world_m - before.position_world_m).norm() <
          0.05 + 0.01 + 1.3 * seconds_between(0, missing_ns));
  }
}

SCENARIO(
    "a stronger fusion takes over when it starts and hands over when it ends, without a missing sample or "
    "a jump") {
  GIVEN("a fusion that serves two beacons, one with each engine") {
    const Arguments engines{"--set", "beacon.7.fusion.engine=documented", "--set",
                            "beacon.8.fusion.engine=kalman"};
    Pair pair({"--scenario", "walk", "--imu-rate", "200", "--beacons", "2"});
    Arguments quick = engines;
    quick.insert(quick.end(), {"--warm-up", "0.2"});
    const Fusion weak = pair.start("100", quick);
    pair.wait_until_served_by(weak);
    WHEN("a stronger one starts, serves and ends") {
      const faults::StallWatch stalls;
      const std::size_t begin = pair.tap.count();
      const Fusion strong = pair.start("200", engines);
      const auto wait_for_both = [&](const Writers& writers, std::size_t from) {
        for (const BeaconAddress address : {contested, undisputed}) {
          std::size_t served = 0;
          REQUIRE(pair.tap.wait_for(
              [&](const TappedPose& tapped) {
                return tapped.pose.address == address && writers.contains(tapped.writer) && ++served == 20;
              },
              from));
        }
      };
      wait_for_both({strong.claim}, begin);
      const std::size_t before_end = pair.tap.count();
      CHECK(strong.process->end_by(SIGTERM).code == 0);
      wait_for_both(weak.writers, before_end);
      THEN("each beacon has a pose for every sample, and they are close to each other") {
        std::map<BeaconAddress, std::vector<TappedPose>> poses;
        for (const TappedPose& tapped : pair.tap.since(begin)) poses[tapped.pose.address].push_back(tapped);
        const auto disjoint = faults::merged(stalls.stalls());
        for (const auto& entry : poses) check_hand_overs(entry.second, strong, weak, disjoint);
      }
    }
  }
}

SCENARIO("a silent beacon is released, and claimed again when it returns") {
  GIVEN("a fusion that claims two beacons of two bridges") {
    Pair pair({"--scenario", "rest", "--imu-rate", "200", "--address", "7"});
    const auto other = pair.bus.bridge({"--scenario", "rest", "--imu-rate", "200", "--address", "8"});
    Consumer<sonopose_FusionStatus> status(pair.bus, topics::fusion_status, dds::topics::Delivery::live);
    const Fusion fusion = pair.start("100");
    const auto wait_for_role = [&](FusionRole role, bool silent) {
      return status.wait_for(
          [&](const FusionStatus& latest) {
            return latest.address == 7 && latest.role == role && latest.imu_silent == silent;
          },
          status.samples.size());
    };
    REQUIRE(wait_for_role(FusionRole::serving, false));
    WHEN("one of the bridges is stopped") {
      pair.bridge->send(SIGSTOP);
      THEN("its beacon is reported silent and released, and the other one is still served") {
        REQUIRE(wait_for_role(FusionRole::stalled, true));
        REQUIRE(pair.tap.wait_for([](const TappedPose& tapped) { return tapped.pose.address == 8; },
                                  pair.tap.count()));
        CHECK(status.samples.back().strength == 100);
        AND_WHEN("it continues") {
          const std::size_t before = pair.tap.count();
          pair.bridge->send(SIGCONT);
          THEN("it is served again") {
            REQUIRE(pair.tap.wait_for(
                [&](const TappedPose& tapped) {
                  return tapped.pose.address == 7 && tapped.writer == fusion.claim;
                },
                before));
          }
        }
      }
      pair.bridge->send(SIGCONT);
    }
  }
}

SCENARIO("a beacon that only the stronger fusion has lost is taken over while that fusion is alive") {
  GIVEN("two fusions, each with its own bridge to the same beacon, and a consumer of both") {
    const Bus bus;
    const PoseTap tap(bus, "way-*");
    const auto bridge_in = [&bus](const std::string& partition) {
      return bus.bridge({"--scenario", "rest", "--imu-rate", "200", "--partition", partition});
    };
    const auto strong_bridge = bridge_in("way-1");
    const auto weak_bridge = bridge_in("way-2");
    const auto strong = bus.fusion({"--partition", "way-1", "--standby-strength", "200", "--warm-up", "0.2"});
    const auto from_strong = [&] {
      for (const auto writer : tap.writers()) {
        if (tap.strength_of(writer) == 200) return tap.wait_for_writer({writer}, tap.count());
      }
      return std::optional<TappedPose>();
    };
    REQUIRE(tap.wait_for([](const TappedPose&) { return true; }, 0));
    const auto served = from_strong();
    REQUIRE(served);
    const auto weak = bus.fusion({"--partition", "way-2", "--standby-strength", "100", "--warm-up", "0.2"});
    WHEN("the bridge of the stronger fusion falls silent") {
      const std::size_t before = tap.count();
      strong_bridge->send(SIGSTOP);
      THEN("the weaker one serves, and the stronger one again when the bridge is back") {
        REQUIRE(
            tap.wait_for([&](const TappedPose& tapped) { return tapped.writer != served->writer; }, before));
        strong_bridge->send(SIGCONT);
        REQUIRE(tap.wait_for_writer({served->writer}, tap.count()));
      }
    }
  }
}

}  // namespace standby_test
