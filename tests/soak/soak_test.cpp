/// A long run with beacons that come and go, started by scripts/soak.

#include "clocks/clocks.hpp"
#include "soak/usage.hpp"
#include "support/beacon_feed.hpp"
#include "support/bus.hpp"
#include "support/pose_tap.hpp"
#include "support/udp_sender.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <set>
#include <stdexcept>

namespace soak_test {

using namespace sonopose;
using namespace sonopose::test;
using namespace sonopose::soak;

constexpr double imu_rate_hz = 25;
constexpr int beacons_at_a_time = 50;
constexpr BeaconAddress last_address = 250;  // one byte in a datagram
constexpr TimeNs change_ns = 2'000'000'000;  // a beacon lives for 100 s and returns after 400 s
constexpr TimeNs visit_ns = 30'000'000'000;
constexpr TimeNs sample_ns = 10'000'000'000;

double chosen_hours() {
  const char* const text = std::getenv("SONOPOSE_SOAK_HOURS");
  char* end = nullptr;
  const double hours = text == nullptr ? 0 : std::strtod(text, &end);
  if (text == nullptr || *end != '\0' || !(hours > 0)) {
    throw std::invalid_argument("SONOPOSE_SOAK_HOURS is '" + std::string(text == nullptr ? "" : text) +
                                "': expected a number of hours above 0");
  }
  return hours;
}

/// A program without output.
std::unique_ptr<Process> silent(const char* program, const Arguments& arguments) {
  Arguments all{"-c", R"(exec "$0" "$@" >/dev/null)", program};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return std::make_unique<Process>("/bin/sh", all);
}

/// Beacons of one UDP line: every two seconds the oldest leaves and the next address joins.
class ComingAndGoing {
public:
  explicit ComingAndGoing(const UdpSender& line)
      : feed_(BeaconFeed::Format::datagrams, imu_rate_hz,
              [&line](std::span<const std::uint8_t> bytes) { line.send(bytes); }) {
    for (int i = 0; i < beacons_at_a_time; ++i) add_next();
  }

  void change() {
    feed_.remove(oldest_);
    oldest_ = after(oldest_);
    add_next();
  }

private:
  static BeaconAddress after(BeaconAddress address) {
    return address == last_address ? BeaconAddress{1} : static_cast<BeaconAddress>(address + 1);
  }

  void add_next() {
    feed_.add(next_);
    next_ = after(next_);
  }

  BeaconFeed feed_;
  BeaconAddress oldest_ = 1;
  BeaconAddress next_ = 1;
};

/// Bridges that come and go, each with five beacons whose addresses return after 5.8 hours. Optional, because
/// Cyclone DDS 0.10 never frees all memory of a discovered endpoint.
class Visitors {
public:
  explicit Visitors(const Bus& bus) : bus_(bus) {
    const char* const text = std::getenv("SONOPOSE_SOAK_VISITORS");
    wanted_ = text != nullptr && *text != '\0';
  }

  void change() {
    if (!wanted_) return;
    constexpr int beacons = 5;
    constexpr int first = 1000;
    constexpr int most = 3'500;  // the admission accepts 4,096 addresses
    if (bridge_) CHECK(bridge_->end_by(SIGTERM).code == 0);
    bridge_ = bus_.bridge({"--address", std::to_string(first + next_), "--beacons", std::to_string(beacons),
                           "--imu-rate", std::to_string(imu_rate_hz)});
    next_ = (next_ + beacons) % most;
  }

private:
  const Bus& bus_;
  bool wanted_ = false;
  std::unique_ptr<Process> bridge_;
  int next_ = 0;
};

struct Watched {
  std::string name;
  std::unique_ptr<Process> process;
  std::vector<Usage> usages;
};

void print(const std::vector<Watched>& all, double duration_s) {
  std::cout << fmt::format("{:<12} {:>8} {:>22} {:>12} {:>8}\n", "process", "mean MB", "growth, % an hour",
                           "descriptors", "threads");
  for (const Watched& each : all) {
    const Judgement judgement = judge(each.name, each.usages);
    std::cout << fmt::format("{:<12} {:>8.1f} {:>12.2f} ± {:<7.2f} {:>+12} {:>+8}\n", each.name,
                             judgement.resident_mb, judgement.growth.percent_per_hour,
                             2 * judgement.growth.std_error, judgement.more_descriptors,
                             judgement.more_threads);
  }
  if (duration_s < min_judged_s) {
    std::cout
        << "A run shorter than an hour proves little about memory: its growth is printed, not judged.\n";
  }
}

SCENARIO("the processes of a long run do not grow", "[.][soak]") {
  const double duration_s = chosen_hours() * 3600;
  const char* const csv_name = std::getenv("SONOPOSE_SOAK_CSV");
  std::ofstream csv(csv_name == nullptr ? "/dev/null" : csv_name);
  csv << "time_s,process,resident_kb,descriptors,threads\n";
  const Bus bus;
  const UdpSender line;
  const std::string domain = std::to_string(bus.domain_id());
  std::vector<Watched> all;
  const auto watch = [&all](const char* name, std::unique_ptr<Process> process) {
    all.push_back({name, std::move(process), {}});
  };
  watch("bridge", bus.bridge({"--source", "udp", "--listen", line.endpoint()}));
  watch("fusion-200", bus.fusion({"--standby-strength", "200", "--warm-up", "1"}));
  watch("fusion-100", bus.fusion({"--standby-strength", "100", "--warm-up", "1"}));
  watch("relay", bus.ros2());
  watch("monitor", silent(SONOPOSE_TEST_MONITOR, {"--json", "--domain", domain}));
  ComingAndGoing beacons(line);
  Visitors visitors(bus);
  const SteadyTime begin = clocks::steady_now();
  SteadyTime change_due = begin + change_ns;
  SteadyTime visit_due = begin;
  SteadyTime sample_due = begin + sample_ns;
  while (clocks::steady_now() < begin + to_ns(duration_s)) {
    const SteadyTime due = std::min({change_due, visit_due, sample_due});
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::max<TimeNs>(0, due - clocks::steady_now())));
    if (due == change_due) {
      beacons.change();
      change_due += change_ns;
    } else if (due == visit_due) {
      visitors.change();
      visit_due += visit_ns;
    } else {
      for (Watched& each : all) {
        each.usages.push_back(usage_of(each.process->pid(), seconds_between(begin, clocks::steady_now())));
        const Usage& usage = each.usages.back();
        csv << fmt::format("{:.1f},{},{:.0f},{},{}\n", usage.time_s, each.name, usage.resident_kb,
                           usage.descriptors, usage.threads);
      }
      csv.flush();
      sample_due += sample_ns;
    }
  }
  print(all, duration_s);
  for (const Watched& each : all)
    CHECK(judge(each.name, each.usages).violations == std::vector<std::string>{});
  // The programs still work.
  const PoseTap tap(bus);
  std::set<BeaconAddress> served;
  for (const TappedPose& tapped : tap.wait_for_count(0, 2000)) served.insert(tapped.pose.address);
  CHECK(served.size() >= beacons_at_a_time);
  for (const Watched& each : all) CHECK(each.process->end_by(SIGTERM).code == 0);
}

}  // namespace soak_test
