#include "monitor/monitor_node.hpp"

#include "clocks/clocks.hpp"
#include "monitor/display.hpp"
#include "monitor/monitor_report.hpp"
#include "observation/bus/bus_watch.hpp"
#include "terminal/crash_restore.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace sonopose::monitor {
namespace {

/// Unblocks the crash signals in the receive threads of Cyclone DDS, which block all signals: a crash must
/// restore the terminal.
class CrashSignals final : public observation::bus::SampleHook {
public:
  using SampleHook::on;
  void on(const FusedPose& /*pose*/) noexcept override { terminal::unblock_crash_signals(); }
};

/// Summaries of the beacons that are gone: the last visit of each.
class GoneBeacons {
public:
  void add(std::vector<observation::BeaconView> gone) {
    for (observation::BeaconView& view : gone) {
      poses_ += view.poses;
      summaries_.insert_or_assign(view.address, std::move(view));
    }
  }

  /// Number of poses of all visits.
  [[nodiscard]] std::uint64_t poses() const { return poses_; }
  [[nodiscard]] const std::map<BeaconAddress, observation::BeaconView>& summaries() const {
    return summaries_;
  }

private:
  std::uint64_t poses_ = 0;
  std::map<BeaconAddress, observation::BeaconView> summaries_;
};

/// Next time of a period. Times missed while the process was stopped are skipped.
SteadyTime after(SteadyTime due, TimeNs period_ns) {
  const SteadyTime now = clocks::steady_now();
  return due + period_ns > now ? due + period_ns : now + period_ns;
}

}  // namespace

std::uint64_t monitor(const MonitorOptions& options, process::StopSignal& stop) {
  std::unique_ptr<Display> display =
      make_display(options.output);  // sets the locale, so before other threads run
  CrashSignals crash_signals;
  // Only a screen shows the fate of a fix.
  observation::bus::BusWatch bus({.domain = options.domain,
                                  .qos_file = options.qos_file,
                                  .max_beacons = options.max_beacons,
                                  .has_reports = options.output == Output::screen},
                                 &crash_signals);
  GoneBeacons gone;

  constexpr TimeNs period_ns = 1'000'000'000;
  SteadyTime next = clocks::steady_now() + period_ns;
  const SteadyTime end =
      options.duration_s > 0 ? clocks::steady_now() + to_ns(options.duration_s) : SteadyTime::max();
  // Keys are read 20 times a second; without a screen, log lines should come sooner.
  const TimeNs poll_period_ns = options.output == Output::screen ? 50'000'000 : 20'000'000;
  while (next <= end && !stop.wait_until(std::min(next, clocks::steady_now() + poll_period_ns))) {
    if (display->poll()) {
      stop.request();
      break;
    }
    bus.poll();
    if (clocks::steady_now() < next) continue;
    observation::bus::BusSnapshot snapshot = bus.take_snapshot();
    gone.add(std::move(snapshot.gone));
    display->show(std::move(snapshot.beacons), std::move(snapshot.warnings));
    next = after(next, period_ns);
  }
  stop.wait_until(std::min(end, next));
  const auto present = bus.summaries();
  display.reset();  // a screen ends before the summary

  std::vector<observation::BeaconView> summaries;
  for (const auto& entry : gone.summaries()) summaries.push_back(entry.second);
  summaries.insert(summaries.end(), present.begin(), present.end());
  if (options.output != Output::json) fmt::print("\n{}", summary_of(summaries));
  std::uint64_t poses = gone.poses();
  for (const observation::BeaconView& view : present) poses += view.poses;
  return poses;
}

}  // namespace sonopose::monitor
