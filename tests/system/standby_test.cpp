/// Hot standby: two fusions with the same inputs, one of which is taken out.

#include "standby_pair.hpp"
#include "support/held_thread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::standby_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Number of times that a fusion is taken out; docs/standby.md lists results of more.
int kills() {
  const char* const number = std::getenv("SONOPOSE_KILLS");
  return number == nullptr ? 5 : std::atoi(number);
}

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
/// Stops a process. On a busy machine its threads may run on for a moment.
Stop stop_for_a_second(const Process& process) {
  process.send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  const TimeNs from_ns = clocks::host_now();
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
            if (in_bridge_s + after_it_s < sonopose_LATE_AFTER) CHECK_FALSE(is_late(pose));
          }
          CHECK(marked > 0);
          CHECK(status.wait_for([&](const FusionStatus& latest) { return latest.poses_late >= marked; }, 0));
          CHECK(fusion->wait_for_line(Process::Stream::error, "old on arrival"));
        }
      }
    }
  }
}

}  // namespace sonopose::standby_test
