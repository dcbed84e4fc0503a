/// Plays the plans of some seeds and checks the data that a consumer received. The suite's seeds have no
/// absolute time limits; scripts/soak plays other seeds with them:
///
///     SONOPOSE_FAULT_SEEDS=1-300 build/dev/tests/test_faults "[seeds]"

#include "clocks/clocks.hpp"
#include "faults/cast.hpp"
#include "faults/history_checker.hpp"
#include "faults/observer.hpp"
#include "faults/stall_watch.hpp"
#include "support/wait_until.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace seeds_test {

using namespace sonopose;
using namespace sonopose::faults;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
constexpr TimeNs slowness = 5;
#else
constexpr bool sanitized = false;
constexpr TimeNs slowness = 1;
#endif

/// Seeds named by SONOPOSE_FAULT_SEEDS, as "7" or "1-10".
std::vector<std::uint64_t> chosen_seeds() {
  const char* const value = std::getenv("SONOPOSE_FAULT_SEEDS");
  const std::string_view text = value == nullptr ? "" : value;
  const char* const end = text.data() + text.size();
  std::uint64_t first = 0;
  auto parsed = std::from_chars(text.data(), end, first);
  std::uint64_t last = first;
  if (parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == '-') {
    parsed = std::from_chars(parsed.ptr + 1, end, last);
  }
  if (parsed.ec != std::errc() || parsed.ptr != end || last < first) {
    throw std::invalid_argument("SONOPOSE_FAULT_SEEDS is '" + std::string(text) + "': expected 7 or 1-10");
  }
  std::vector<std::uint64_t> seeds(last - first + 1);
  std::iota(seeds.begin(), seeds.end(), first);
  return seeds;
}

bool can_step_clocks() {
  return !sanitized && !faketime_library().empty();  // a sanitizer must be the first library to be loaded
}

std::size_t beacons() {
  return Cast::last_address() - Cast::first_address + 1U;
}

/// Returns true if all fusions of the plan have since reported that they serve every beacon.
bool all_serve(const Plan& plan, const std::vector<FusionReport>& reports, SteadyTime since = {}) {
  std::set<std::pair<std::int32_t, BeaconAddress>> serving;
  for (const FusionReport& report : reports) {
    const auto key = std::pair{report.status.strength, report.status.address};
    if (report.received >= since && report.status.role == FusionRole::serving) serving.insert(key);
  }
  return serving.size() == beacons() * static_cast<std::size_t>(plan.fusions);
}

/// Poses of a series.
constexpr std::size_t row = 80;

/// Returns true if every beacon has a series of good poses from this index on.
bool flows(const std::vector<Arrival>& poses, std::size_t from) {
  constexpr std::uint32_t bad = status_initialising | status_stale | status_late;
  std::map<BeaconAddress, std::size_t> good;
  for (std::size_t i = from; i < poses.size(); ++i) {
    std::size_t& count = good[poses[i].address];
    count = (poses[i].status & bad) == 0U ? count + 1 : 0;
  }
  return good.size() == beacons() &&
         std::all_of(good.begin(), good.end(), [](const auto& entry) { return entry.second >= row; });
}

void wait_for_recovery(const Observer& observer, const Plan& plan) {
  const std::size_t from = observer.with_poses([](const auto& poses) { return poses.size(); });
  test::wait_until([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return observer.with_poses([from](const auto& poses) { return flows(poses, from); });
  });
  // Wait for one more report of each fusion's losses.
  const SteadyTime recovered = clocks::steady_now();
  observer.wait_for_reports([&](const std::vector<FusionReport>& reports) {
    std::set<std::pair<std::int32_t, BeaconAddress>> heard;
    for (const FusionReport& report : reports) {
      if (report.received > recovered) heard.emplace(report.status.strength, report.status.address);
    }
    return heard.size() >= beacons() * static_cast<std::size_t>(plan.fusions);
  });
}

/// Kind of the time limits for poses.
enum class Timing : std::uint8_t {
  limited,  ///< absolute limits in milliseconds plus the stalls of the machine during each wait
  relative  ///< limits that additionally grow by twice the stalls of the whole run
};

Limits limits_of_run(Timing timing, TimeNs stalled_ns) {
  Limits limits;
  for (TimeNs Limits::*const limit :
       {&Limits::silence_ns, &Limits::age_ns, &Limits::transit_ns, &Limits::unowned_lag_ns,
        &Limits::recovery_ns, &Limits::takeover_lag_ns}) {
    limits.*limit *= slowness;
    if (timing == Timing::relative) limits.*limit += 2 * stalled_ns;
  }
  if (timing == Timing::relative)
    limits.unknown_ages += static_cast<std::size_t>(Cast::imu_rate_hz * seconds_between(0, 2 * stalled_ns));
  return limits;
}

struct Outcome {
  Plan plan;
  Verdict verdict;
  std::size_t poses = 0;
  TimeNs longest_stall_ns = 0;  ///< longest stall of the machine
};

TimeNs longest_of(const std::vector<Interval>& intervals) {
  TimeNs longest_ns = 0;
  for (const Interval& each : intervals) longest_ns = std::max(longest_ns, each.until - each.from);
  return longest_ns;
}

Outcome play(const Plan& plan, Timing timing) {
  const test::Bus bus;
  const StallWatch stall_watch;
  Observer observer(bus);
  Cast cast(bus, plan);
  History history;
  history.plan = plan;
  for (auto address = Cast::first_address; address <= Cast::last_address(); ++address) {
    history.beacons.push_back(address);
  }
  history.imu_period_ns = to_ns(1 / Cast::imu_rate_hz);
  const bool served =
      observer.wait_for_reports([&](const auto& reports) { return all_serve(plan, reports); });
  observer.start();
  cast.play();
  wait_for_recovery(observer, plan);
  history.end = clocks::steady_now();
  observer.add_to(history);
  history.episodes = cast.episodes();
  history.lives = cast.lives();
  history.stalls = stall_watch.stalls();
  const Limits limits = limits_of_run(timing, HistoryChecker(history).check().stalled_ns);
  Outcome outcome{plan, HistoryChecker(history, limits).check(), history.poses.size(),
                  longest_of(history.stalls)};
  const bool serve_again =
      observer.wait_for_reports([&](const auto& reports) { return all_serve(plan, reports, history.end); });
  auto failures = cast.finish();
  if (!serve_again) failures.emplace_back("the fusions do not all serve again");
  if (!served) failures.emplace_back("the fusions did not all serve within the time limit");
  auto& violations = outcome.verdict.violations;
  violations.insert(violations.end(), failures.begin(), failures.end());
  return outcome;
}

void print_header() {
  std::cout << fmt::format("{:>5} {:>6} {:>8} {:>10} {:>7} {:>5} {:>9} {:>7} {:>8} {:>10}  {:<7} {}\n",
                           "seed", "poses", "stall ms", "silence ms", "age ms", "old", "recover s", "owners",
                           "counted", "uncounted", "result", "plan");
}

void print_row(const Outcome& outcome, const char* result) {
  const Verdict& verdict = outcome.verdict;
  std::cout << fmt::format(
      "{:>5} {:>6} {:>8.0f} {:>10.1f} {:>7.1f} {:>5} {:>9.2f} {:>7} {:>8} {:>10}  {:<7} {}\n",
      outcome.plan.seed, outcome.poses, 1e-6 * static_cast<double>(verdict.stalled_ns),
      1e-6 * static_cast<double>(verdict.longest_silence_ns),
      1e-6 * static_cast<double>(verdict.longest_age_ns), verdict.old_poses,
      seconds_between(0, verdict.recovery_ns), verdict.owner_changes, verdict.missing_counted,
      verdict.missing_uncounted, result, text_of(outcome.plan));
  for (const std::string& violation : verdict.violations) std::cout << "      " << violation << "\n";
  std::cout << std::flush;
}

void play_and_judge(std::uint64_t seed, Timing timing) {
  const Plan plan = draw_plan(seed, can_step_clocks());
  Outcome outcome = play(plan, timing);
  constexpr TimeNs stall_ns = 50'000'000;
  if (!outcome.verdict.violations.empty() && outcome.longest_stall_ns > stall_ns) {
    print_row(outcome, "stalled");  // the machine's fault, so play it once more
    outcome = play(plan, timing);
  }
  print_row(outcome, outcome.verdict.violations.empty() ? "ok" : "FAILED");
  INFO("repeat it with: SONOPOSE_FAULT_SEEDS=" << seed << " build/dev/tests/test_faults \"[seeds]\"");
  CHECK(outcome.verdict.violations == std::vector<std::string>{});
}

void print_clock_steps() {
  if (can_step_clocks()) return;
  std::cout
      << "no clock steps: libfaketime (package faketime) is not installed, or this is a sanitized build\n";
}

SCENARIO("whatever happens to the processes and the line, consumers receive what is promised in time",
         "[.][seeds]") {
  print_clock_steps();
  print_header();
  for (const std::uint64_t seed : chosen_seeds()) play_and_judge(seed, Timing::limited);
}

void play_in_suite(std::uint64_t seed) {
  if (!std::filesystem::exists("/proc/self/schedstat")) {
    std::cout << "skipped: the kernel does not say how long threads wait (CONFIG_SCHED_INFO)\n";
    return;
  }
  print_clock_steps();
  print_header();
  play_and_judge(seed, Timing::relative);
}

SCENARIO("after the faults of the first seed of the suite consumers have received what is promised",
         "[short-seeds]") {
  play_in_suite(short_seeds[0]);
}

SCENARIO("after the faults of the second seed of the suite consumers have received what is promised",
         "[short-seeds]") {
  play_in_suite(short_seeds[1]);
}

SCENARIO("after the faults of the third seed of the suite consumers have received what is promised",
         "[short-seeds]") {
  play_in_suite(short_seeds[2]);
}

}  // namespace seeds_test
