/// A fusion that gets too little processor time.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <map>
#include <mutex>
#include <set>
#include <thread>

namespace overload_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

/// Counts poses and their ages at arrival.
struct PoseAges final : dds::DataReaderListener<sonopose_FusedPose> {
  struct Count {
    std::map<BeaconAddress, std::size_t> beacons;  ///< poses of each
    std::size_t overloaded = 0;
    std::vector<double> ages_s;  ///< from the IMU sample to the arrival of its pose

    [[nodiscard]] std::size_t least() const {
      std::size_t least = ages_s.size();
      for (const auto& entry : beacons) least = std::min(least, entry.second);
      return least;
    }
  };

  void on_data_available(dds::DataReader<sonopose_FusedPose>& reader) noexcept override {
    const TimeNs now_ns = clocks::host_now();
    const std::lock_guard lock(mutex);
    reader.try_take_each([&](const sonopose_FusedPose& pose, const dds::SampleInfo&) {
      ++count.beacons[pose.address];
      if ((pose.status & status_overloaded) != 0) ++count.overloaded;
      count.ages_s.push_back(seconds_between(pose.imu_sensor_time, now_ns));
    });
  }

  /// What came since the last call.
  Count take() {
    const std::lock_guard lock(mutex);
    return std::exchange(count, {});
  }

  std::mutex mutex;
  Count count;
};

/// Processor time of all threads of a process.
double cpu_time_s(const Process& process) {
  clockid_t clock = 0;
  timespec time{};
  if (::clock_getcpuclockid(process.pid(), &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Lets a process run for 4 ms of every 20 ms, once it has had a fifth of a core: other programs may keep it
/// from using the 4 ms.
class DutyCycle {
public:
  explicit DutyCycle(const Process& process) : process_(process) {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      const SteadyTime began = clocks::steady_now();
      const double used_before_s = cpu_time_s(process_);
      while (!stop.stop_requested()) {
        const double passed_s = seconds_between(began, clocks::steady_now());
        if (cpu_time_s(process_) - used_before_s >= share_ * passed_s) {
          process_.send(SIGSTOP);
          pause(std::chrono::milliseconds(static_cast<int>(4 / share_) - 4));
          process_.send(SIGCONT);
        }
        pause(std::chrono::milliseconds(4));
      }
    });
  }

  /// Takes a quarter of that share away: much less than it needs would be another test.
  void tighten() { share_ = 0.75 * share_; }

  /// The longest time for which the process may not run: the pause that is meant, and what other programs
  /// add.
  [[nodiscard]] double longest_pause_s() const { return 4e-3 / share_ + longest_stall_s_; }

private:
  void pause(std::chrono::milliseconds duration) {
    const SteadyTime began = clocks::steady_now();
    std::this_thread::sleep_for(duration);
    const double stall_s =
        seconds_between(began, clocks::steady_now()) - std::chrono::duration<double>(duration).count();
    longest_stall_s_ = std::max(longest_stall_s_.load(), stall_s);
  }

  const Process& process_;
  std::atomic<double> share_ = 0.2;
  std::atomic<double> longest_stall_s_ = 0;
  std::jthread thread_;
};

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// The share of a core that a busy thread gets next to the other programs of the machine.
double core_share() {
  const auto thread_s = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const SteadyTime began = clocks::steady_now();
  const double cpu_began_s = thread_s();
  while (seconds_between(began, clocks::steady_now()) < 0.5) {
  }
  return std::min(1.0, (thread_s() - cpu_began_s) / seconds_between(began, clocks::steady_now()));
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool judges_time = false;  // a sanitizer makes some steps ten times slower, and others not
#else
constexpr bool judges_time = true;
#endif

/// How many beacons overload the machine of docs/reliability.md well; SONOPOSE_OVERLOAD_BEACONS replaces it.
int reference_beacons() {
  constexpr int beacons = 100;
  const char* const given = std::getenv("SONOPOSE_OVERLOAD_BEACONS");
  return given == nullptr ? beacons : std::stoi(given);
}

/// Fewer than on the reference machine where a sample costs more, as under a sanitizer, or where other
/// programs use the cores.
int beacons_for_this_machine() {
  constexpr double reference_s = 40e-6;
  constexpr int beacons = 50;
  const Bus bus;
  PoseAges poses;
  const auto participant = dds::make_participant({.domain_id = bus.domain_id()});
  const auto reader = topics::make_reader(participant, dds::qos::Provider(), topics::pose, &poses);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--beacons", std::to_string(beacons)});
  sleep_s(2.0);
  poses.take();
  const double before_s = cpu_time_s(*fusion);
  const double share = core_share();
  sleep_s(1.5);
  const std::size_t count = poses.take().ages_s.size();
  REQUIRE(count > 0);
  const double per_sample_s = (cpu_time_s(*fusion) - before_s) / static_cast<double>(count);
  const double scale = std::min(1.0, reference_s / per_sample_s) * share * share;
  const int chosen = std::max(5, static_cast<int>(reference_beacons() * scale));
  fmt::print(
      "overload: {} beacons: {:.0f} us of the fusion's time per sample, {:.0f} % of a core for a busy "
      "thread\n",
      chosen, per_sample_s * 1e6, share * 100);
  return chosen;
}

SCENARIO("an overloaded fusion still serves every beacon") {
  GIVEN("a fusion for many beacons at 100 Hz") {
    const int beacons = beacons_for_this_machine();
    const Bus bus;
    PoseAges poses;
    const auto participant = dds::make_participant({.domain_id = bus.domain_id()});
    const auto reader = topics::make_reader(participant, dds::qos::Provider(), topics::pose, &poses);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    Consumer<sonopose_BeaconStatus> bridge_status(bus, topics::beacon_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--beacons", std::to_string(beacons)});
    const auto is_overloaded = [](const FusionStatus& latest) { return latest.overloaded; };
    const auto is_normal = [](const FusionStatus& latest) { return !latest.overloaded; };
    std::set<BeaconAddress> settled;
    REQUIRE(status.wait_for([&](const FusionStatus& latest) {
      if (latest.fixes_used > 10) settled.insert(latest.address);
      return settled.size() == static_cast<std::size_t>(beacons);
    }));
    WHEN("it runs for 4 ms of every 20 ms") {
      auto limit = std::make_optional<DutyCycle>(*fusion);
      const auto wait_s = [&status](double seconds) {
        status.wait_until([] { return false; }, std::chrono::milliseconds(static_cast<int>(1e3 * seconds)));
      };
      // Other programs may have misled the choice of the number of beacons: fewer are overloaded by less
      // time.
      const auto is_overloaded_for_long = [&] {
        poses.take();
        wait_s(2.0);
        const PoseAges::Count count = poses.take();
        return 2 * count.overloaded > count.ages_s.size();
      };
      bool overloaded = is_overloaded_for_long();
      for (int tries = 0; !overloaded && tries < 10; ++tries) {
        limit->tighten();
        overloaded = is_overloaded_for_long();
      }
      REQUIRE(overloaded);
      CHECK(std::any_of(status.samples.begin(), status.samples.end(), is_overloaded));
      const std::size_t statuses_before = status.samples.size();
      poses.take();
      constexpr double measured_s = 5.0;
      wait_s(measured_s);
      const PoseAges::Count count = poses.take();
      bridge_status.take();
      const double oldest_s = 0.23 + limit->longest_pause_s();
      THEN("each beacon has recent poses that say so, and its fixes are used") {
        CHECK(count.beacons.size() == static_cast<std::size_t>(beacons));
        if (judges_time) CHECK(count.least() >= static_cast<std::size_t>(5 * measured_s));
        const auto old = std::count_if(count.ages_s.begin(), count.ages_s.end(),
                                       [oldest_s](double age_s) { return age_s > oldest_s; });
        if (judges_time) CHECK(static_cast<double>(old) <= 0.05 * static_cast<double>(count.ages_s.size()));
        CHECK(count.overloaded > 0);

        std::map<BeaconAddress, std::pair<FusionStatus, FusionStatus>> spans;
        for (std::size_t i = statuses_before; i < status.samples.size(); ++i) {
          const FusionStatus& each = status.samples[i];
          spans.try_emplace(each.address, each, each).first->second.second = each;
        }
        double used_hz = 0;
        double sent_hz = 0;
        std::map<BeaconAddress, double> fix_rates_hz;
        for (const BeaconStatus& each : bridge_status.samples) fix_rates_hz[each.address] = each.fix_rate_hz;
        for (const auto& [address, span] : spans) {
          const auto& [first, last] = span;
          REQUIRE(last.time_ns > first.time_ns);
          used_hz += static_cast<double>(last.fixes_used - first.fixes_used) /
                     seconds_between(first.time_ns, last.time_ns);
          sent_hz += fix_rates_hz[address];
        }
        CHECK(spans.size() == static_cast<std::size_t>(beacons));
        CHECK(used_hz > 0.9 * sent_hz);
        fmt::print(
            "overload: {:.1f} poses/s of the worst beacon, oldest {:.0f} ms, {:.2f} % above {:.0f} ms, "
            "{:.0f} % of the "
            "fixes used\n",
            static_cast<double>(count.least()) / measured_s,
            1e3 * *std::max_element(count.ages_s.begin(), count.ages_s.end()),
            100.0 * static_cast<double>(old) / static_cast<double>(count.ages_s.size()), 1e3 * oldest_s,
            100 * used_hz / sent_hz);
        AND_WHEN("the limit ends") {
          limit.reset();
          THEN("it recovers, and has logged both") {
            CHECK(status.wait_for(is_normal, status.samples.size()));
            CHECK(fusion->wait_for_line(Stream::error, "sonopose-fusion: warning: overloaded"));
            CHECK(fusion->wait_for_line(Stream::error, "no longer overloaded"));
          }
        }
        AND_WHEN("the bridge ends") {
          bridge->end_by(SIGKILL);
          THEN("it is no longer overloaded, and reports the silence") {
            CHECK(status.wait_for(is_normal, status.samples.size()));
            CHECK(status.wait_for([](const FusionStatus& latest) { return latest.imu_silent; },
                                  status.samples.size()));
          }
        }
      }
    }
  }
}

}  // namespace overload_test
