/// Hot standby: two fusions with the same inputs.

#include "support/held_thread.hpp"
#include "support/pose_tap.hpp"

#include <fmt/format.h>

#include <csignal>
#include <functional>
#include <iostream>

namespace standby_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

constexpr int kills = 20;
constexpr double lease_ms = 100.0;
constexpr double imu_period_ms = 5.0;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double slowness = 5.0;
#else
constexpr double slowness = 1.0;
#endif

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
    const auto give_up = std::chrono::steady_clock::now() + timeout;
    while (fusion.writers.size() < 2 && std::chrono::steady_clock::now() < give_up) {
      fusion.writers = tap.writers();
      for (const auto handle : before) fusion.writers.erase(handle);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
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

/// Takes the strong fusion out `times` times and measures how long the consumer waits for the weak one.
std::vector<double> takeovers_ms(Pair& pair, Fusion& strong, const Fusion& weak,
                                 const std::function<std::function<void()>()>& take_out, int times = kills) {
  std::vector<double> waits_ms;
  for (int i = 0; i < times; ++i) {
    pair.wait_until_served_by(strong);
    const std::size_t before = pair.tap.count();
    const SteadyTime out = clocks::steady_now();
    const auto bring_back = take_out();
    const auto first = pair.tap.wait_for_writer(weak.writers, before);
    REQUIRE(first);
    waits_ms.push_back(static_cast<double>(first->received - out) * 1e-6);
    bring_back();
  }
  std::sort(waits_ms.begin(), waits_ms.end());
  return waits_ms;
}

void report(const std::string& what, const std::vector<double>& waits_ms) {
  const double median_ms = waits_ms[waits_ms.size() / 2];
  std::cout << fmt::format(
      "{}: taken over after {:.1f} / {:.1f} / {:.1f} ms (min/median/max of {}), lease {} ms\n", what,
      waits_ms.front(), median_ms, waits_ms.back(), waits_ms.size(), lease_ms);
  CHECK(median_ms <= slowness * (1.1 * lease_ms + imu_period_ms));
  CHECK(waits_ms[waits_ms.size() * 9 / 10] <=
        slowness * 2.0 * lease_ms);  // a busy machine delays some takeovers
}

/// All poses before the first of the weak fusion are from the strong one.
void check_one_stream(const std::vector<TappedPose>& poses, const Fusion& weak) {
  std::uint64_t latest = 0;
  for (const TappedPose& tapped : poses) {
    if (weak.wrote(tapped)) break;
    REQUIRE(tapped.pose.sequence > latest);
    latest = tapped.pose.sequence;
  }
}

SCENARIO("a killed fusion is replaced within its lease") {
  const std::string engine = GENERATE("documented", "kalman");
  const Arguments further{"--warm-up", "0.2", "--set", "fusion.engine=" + engine};
  Pair pair;
  Fusion strong = pair.start("200", further);
  const Fusion weak = pair.start("100", further);
  const auto kill = [&]() -> std::function<void()> {
    strong.process->send(SIGKILL);
    return [&] {
      strong.process->wait_for_exit();
      strong = pair.start("200", further);
    };
  };
  // What takes over does not depend on the engine, so one of them is killed less often.
  const auto waits_ms = takeovers_ms(pair, strong, weak, kill, engine == "documented" ? kills : 12);
  report("kill -9, " + engine, waits_ms);
}

SCENARIO("a stopped fusion is replaced within its lease, and serves again when it continues") {
  Pair pair;
  Fusion strong = pair.start("200");
  const Fusion weak = pair.start("100");
  const auto waits_ms = takeovers_ms(pair, strong, weak, [&]() -> std::function<void()> {
    strong.process->send(SIGSTOP);
    return [&] { strong.process->send(SIGCONT); };
  });
  report("SIGSTOP", waits_ms);
}

/// From a time of a pose, by the clock that all processes share, until the consumer received it.
double age_s(const TappedPose& tapped, TimeNs FusedPose::*since_ns, TimeNs steady_to_host_ns) {
  return seconds_between(tapped.pose.*since_ns, tapped.received.ns + steady_to_host_ns);
}

TimeNs steady_to_host_ns() {
  return clocks::host_now() - clocks::steady_now().ns;
}

SCENARIO("a process that was stopped for seconds passes nothing old off as live") {
  const double late_s = slowness * sonopose_LATE_AFTER;
  const auto stop_for_two_seconds = [](const Process& process) {
    process.send(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::seconds(2));  // what it will find is 2 s old
    process.send(SIGCONT);
  };
  GIVEN("a standby that serves meanwhile") {
    Pair pair({"--scenario", "walk"});
    const Fusion strong = pair.start("200");
    const Fusion weak = pair.start("100");
    pair.wait_until_served_by(strong);
    WHEN("the stronger one continues") {
      const std::size_t before = pair.tap.count();
      stop_for_two_seconds(*strong.process);
      const auto weak_from = pair.tap.wait_for_writer(weak.writers, before);
      REQUIRE(weak_from);
      REQUIRE(pair.tap.wait_for_writer({strong.claim}, pair.tap.count()));
      THEN("the consumer receives no old pose, and time never goes back") {
        const TimeNs offset_ns = steady_to_host_ns();
        TimeNs latest_ns = 0;
        for (const TappedPose& tapped : pair.tap.since(before)) {
          CHECK(age_s(tapped, &FusedPose::imu_bridge_time_ns, offset_ns) < late_s);
          CHECK(tapped.pose.time_ns >= latest_ns);
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
    const std::string name = GENERATE("fusion", "bridge");
    // What gathers before a bridge that is stopped leaves it only then.
    const auto since_ns = name == "fusion" ? &FusedPose::imu_bridge_time_ns : &FusedPose::time_ns;
    WHEN("the " + name + " continues") {
      const std::size_t before = tap.count();
      stop_for_two_seconds(name == "fusion" ? *fusion : *bridge);
      const auto is_live = [before_ns = clocks::steady_now()](const TappedPose& tapped) {
        return tapped.received > before_ns + 200'000'000;
      };
      REQUIRE(tap.wait_for(is_live, before));
      THEN("its old poses are marked, counted, and nothing else is") {
        const TimeNs offset_ns = steady_to_host_ns();
        std::uint64_t marked = 0;
        for (const TappedPose& tapped : tap.since(before)) {
          const double old_s = age_s(tapped, since_ns, offset_ns);
          CAPTURE(old_s);
          const bool late = (tapped.pose.status & status_late) != 0U;
          if (late) ++marked;
          if (old_s > late_s + 0.05) CHECK(late);
          if (old_s < sonopose_LATE_AFTER) CHECK_FALSE(late);
        }
        CHECK(marked > 0);
        CHECK(status.wait_for([&](const FusionStatus& latest) { return latest.poses_late >= marked; }, 0));
      }
    }
  }
}

SCENARIO("a fusion whose receive thread hangs is replaced, although its other threads run") {
  Pair pair;
  Fusion strong = pair.start("200");
  const Fusion weak = pair.start("100");
  std::optional<HeldThread> held;
  const auto waits_ms = takeovers_ms(pair, strong, weak, [&]() -> std::function<void()> {
    held.emplace(strong.process->pid(), "recv");
    return [&held] { held.reset(); };
  });
  report("a thread that hangs", waits_ms);
}

SCENARIO("while the stronger fusion is alive, the weaker one delivers nothing and time never goes back") {
  GIVEN("a pair with the stronger fusion serving") {
    Pair pair;
    const Fusion weak = pair.start("100");
    pair.wait_until_served_by(weak);
    const Fusion strong = pair.start("200");
    pair.wait_until_served_by(strong);
    const std::size_t begin = pair.tap.count();
    WHEN("two seconds pass") {
      const auto poses = pair.tap.wait_for_count(begin, 400);
      THEN("each pose is from the stronger one, and of a later IMU sample") {
        check_one_stream(poses, weak);
        for (std::size_t i = 0; i < poses.size(); ++i) {
          REQUIRE(strong.wrote(poses[i]));
          if (i > 0) REQUIRE(poses[i].pose.time_ns > poses[i - 1].pose.time_ns);
        }
      }
    }
  }
}

SCENARIO(
    "a stronger fusion takes over when it starts and hands over when it ends, without a missing sample or "
    "a jump") {
  const std::string engine = GENERATE("documented", "kalman");
  const Arguments set_engine{"--set", "fusion.engine=" + engine};
  Pair pair({"--scenario", "walk", "--imu-rate", "200"});
  const Fusion weak = pair.start("100", {"--warm-up", "0.2", "--set", "fusion.engine=" + engine});
  pair.wait_until_served_by(weak);
  for (int i = 0; i < (engine == "documented" ? 3 : 2); ++i) {
    const std::size_t begin = pair.tap.count();
    const Fusion strong = pair.start("200", set_engine);
    pair.wait_until_served_by(strong);
    REQUIRE(pair.tap.wait_for_count(pair.tap.count(), 40).size() >= 40);
    const std::size_t before_end = pair.tap.count();
    CHECK(strong.process->end_by(SIGTERM).code == 0);
    REQUIRE(pair.tap.wait_for_writer(weak.writers, before_end));
    REQUIRE(pair.tap.wait_for_count(pair.tap.count(), 20).size() >= 20);
    auto poses = pair.tap.since(begin);
    REQUIRE(weak.wrote(poses.front()));
    REQUIRE(weak.wrote(poses.back()));
    // From the last pose before the claim; the start of a process may briefly starve the others.
    const auto claimed = std::find_if(poses.begin(), poses.end(),
                                      [&](const TappedPose& pose) { return pose.writer == strong.claim; });
    REQUIRE(claimed != poses.end());
    poses.erase(poses.begin(), std::prev(claimed));
    std::stable_sort(poses.begin(), poses.end(), [](const TappedPose& a, const TappedPose& b) {
      return a.pose.time_ns < b.pose.time_ns;  // two processes may be some samples apart
    });
    for (std::size_t k = 1; k < poses.size(); ++k) {
      const FusedPose& before = poses[k - 1].pose;
      const FusedPose& after = poses[k].pose;
      INFO(engine << ", hand-over " << i << ", event " << before.sequence << " to " << after.sequence);
      CHECK(std::abs(after.time_ns - before.time_ns) <= 5'001'000);  // the next sample, or the same one twice
      // Walking: at most 1.3 m/s; plus the difference between the engines (late_starter_test).
      CHECK((after.position_world_m - before.position_world_m).norm() < 0.05 + 0.01);
    }
  }
}

SCENARIO("with two beacons, each is served by the strongest fusion that has it") {
  GIVEN("two beacons, and a pair in which the stronger fusion excludes one of them") {
    Pair pair({"--scenario", "rest", "--imu-rate", "200", "--address", "7"});
    const auto other = pair.bus.bridge({"--scenario", "rest", "--imu-rate", "200", "--address", "8"});
    const Fusion weak = pair.start("100");
    const Fusion strong = pair.start("200", {"--warm-up", "0.2", "--addresses", "7"});
    pair.wait_until_served_by(strong);
    const std::size_t begin = pair.tap.count();
    THEN("poses of 7 come from the stronger fusion and poses of 8 from the weaker one") {
      for (const TappedPose& tapped : pair.tap.wait_for_count(begin, 400)) {
        REQUIRE((tapped.pose.address == 7 ? strong : weak).wrote(tapped));
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
      const std::size_t before = pair.tap.count();
      pair.bridge->send(SIGSTOP);
      THEN("its beacon is reported silent and released, and the other one is still served") {
        REQUIRE(wait_for_role(FusionRole::stalled, true));
        REQUIRE(pair.tap.wait_for([](const TappedPose& tapped) { return tapped.pose.address == 8; },
                                  pair.tap.count()));
        CHECK(status.samples.back().strength == 100);
        WHEN("it continues") {
          pair.bridge->send(SIGCONT);
          THEN("it is served again") {
            REQUIRE(pair.tap.wait_for(
                [&](const TappedPose& tapped) {
                  return tapped.pose.address == 7 && tapped.writer == fusion.claim;
                },
                before + 400));
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
