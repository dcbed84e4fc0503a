#include "ros2/relay/diagnostics.hpp"

#include "observation/status_counters.hpp"
#include "observation/status_words.hpp"
#include "observation/stream_state.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <string_view>

namespace sonopose::ros2::relay {
namespace {

using ros2::Level;

/// Limit as in doctor/rules: about 10 % of a Li-Po cell's charge is left.
constexpr double low_battery_v = 3.5;
constexpr std::uint32_t warning_bits = status_initialising | status_uncalibrated | status_stale |
                                       status_converging | status_heading_unknown | status_frozen_track |
                                       status_imu_gap | status_low_trust | status_late | status_overloaded |
                                       status_imu_inconsistent | status_fixes_inconsistent;

/// Collects problems. The most severe one determines the level.
class ProblemList {
public:
  void add(Level level, std::string problem) {
    if (rank(level) > rank(level_)) level_ = level;
    problems_.push_back(std::move(problem));
  }
  void add_increase(std::uint64_t now, std::uint64_t before, std::string_view one, std::string_view several,
                    std::string_view process = {}) {
    if (now <= before) return;
    add(Level::warning, fmt::format("{}{}{}", process, process.empty() ? "" : ": ",
                                    text::count_text(now - before, one, several)));
  }

  [[nodiscard]] Level level() const { return level_; }
  [[nodiscard]] std::string text(const std::string& if_none) const {
    return problems_.empty() ? if_none : fmt::format("{}", fmt::join(problems_, "; "));
  }

private:
  /// Severity of a level. An error outranks stale: it names the cause.
  static int rank(Level level) {
    if (level == Level::error) return 3;
    return level == Level::stale ? 2 : static_cast<int>(level);
  }

  Level level_ = Level::ok;
  std::vector<std::string> problems_;
};

void check_pose(const observation::BeaconView& view, ProblemList& problems) {
  if (view.lost || (!view.fusion && view.poses + view.predicted == 0)) {
    problems.add(Level::error, "no fusion serves it");
  } else if (view.poses + view.predicted == 0) {
    problems.add(Level::stale, "no pose");
  } else if ((view.pose.status & warning_bits) != 0) {
    problems.add(Level::warning, observation::status_words(view.pose.status & warning_bits));
  }
  if (view.fusion && view.fusion->imu_silent) problems.add(Level::error, "IMU silent");
  if (view.wrong_tilt_rad) problems.add(Level::warning, std::string(tilt_words(view)));
}

/// Adds the counters of problems that have increased.
template <class Status, std::size_t Size>
void add_increases(std::string_view process,
                   const std::array<observation::StatusCounter<Status>, Size>& counters, const Status& now,
                   const Status& before, ProblemList& problems) {
  for (const auto& counter : counters) {
    if (counter.problem.empty()) continue;
    problems.add_increase(now.*counter.value, before.*counter.value, counter.problem, counter.problems,
                          process);
  }
}

void check_losses(const observation::BeaconView& view, const observation::BeaconView& before,
                  ProblemList& problems) {
  // A reader continues to miss deadlines after the writer is lost.
  if (!view.lost)
    problems.add_increase(view.deadlines_missed, before.deadlines_missed, "pose deadline missed",
                          "pose deadlines missed");
  problems.add_increase(view.losses, before.losses, "loss of the fusion", "losses of the fusion");
  if (view.bridge && before.bridge) {
    add_increases("bridge", observation::bridge_counters, *view.bridge, *before.bridge, problems);
  }
  if (view.fusion && before.fusion && view.fusion->fusion_id == before.fusion->fusion_id) {
    add_increases("fusion", observation::fusion_counters, *view.fusion, *before.fusion, problems);
  }
}

void check_bridge(const observation::BeaconView& view, TimeNs now_ns, ProblemList& problems) {
  if (!has_bridge(view, now_ns)) {
    problems.add(Level::error, "no status of its bridge");
    return;
  }
  if (view.bridge->battery_v && *view.bridge->battery_v < low_battery_v) {
    problems.add(Level::warning, fmt::format("battery {:.2f} V", *view.bridge->battery_v));
  }
  if (has_several_bridges(view)) problems.add(Level::error, "several bridges");
}

/// Collects keys and values. Omits NaN.
class Values {
public:
  explicit Values(std::vector<std::pair<std::string, std::string>>& values) : values_(values) {}

  void add(std::string_view key, double value, int decimals) {
    if (std::isnan(value)) return;
    values_.emplace_back(std::string(key), fmt::format("{:.{}f}", value, decimals));
  }
  void add(std::string_view key, std::uint64_t count) {
    values_.emplace_back(std::string(key), std::to_string(count));
  }
  void add(std::string_view key, std::string text) {
    values_.emplace_back(std::string(key), std::move(text));
  }

private:
  std::vector<std::pair<std::string, std::string>>& values_;
};

void add_pose(const observation::BeaconView& view, Values& values) {
  values.add("pose_rate_hz", view.pose_rate_hz, 1);
  values.add("latency_p50_ms", view.latency.p50_s * 1e3, 3);
  values.add("latency_p99_ms", view.latency.p99_s * 1e3, 3);
  values.add("pose_deadlines_missed", view.deadlines_missed);
  values.add("fusion_losses", view.losses);
  values.add("status", observation::status_words(view.pose.status));
  values.add("trust", view.pose.trust, 3);
  values.add("since_valid_fix_s", view.pose.since_valid_fix_s, 3);
  values.add("position_std_m", position_std_m(view.pose).maxCoeff(), 4);
  values.add("yaw_std_deg", yaw_std_rad(view.pose) / geometry::radians_per_degree, 2);
  values.add("reset_counter", std::uint64_t{view.pose.reset_counter});
}

/// Adds the counters as "process.name": bridge and fusion have counters of the same names.
template <class Status, std::size_t Size>
void add_counters(std::string_view process,
                  const std::array<observation::StatusCounter<Status>, Size>& counters, const Status& status,
                  Values& values) {
  for (const auto& counter : counters) {
    values.add(fmt::format("{}.{}", process, counter.name), status.*counter.value);
  }
}

void add_bridge(const BeaconStatus& bridge, Values& values) {
  values.add("imu_rate_hz", bridge.imu_rate_hz, 1);
  values.add("fix_rate_hz", bridge.fix_rate_hz, 1);
  values.add("heading_rate_hz", bridge.heading_rate_hz, 1);
  if (bridge.battery_v) values.add("battery_v", *bridge.battery_v, 2);
  if (bridge.rssi_dbm) values.add("rssi_dbm", *bridge.rssi_dbm, 0);
  values.add("clock_offset_s", bridge.clock_offset_s, 6);
  values.add("clock_jitter_s", bridge.clock_jitter_s, 6);
  add_counters("bridge", observation::bridge_counters, bridge, values);
}

}  // namespace

bool has_bridge(const observation::BeaconView& view, TimeNs now_ns) {
  constexpr TimeNs timeout_ns = 3'000'000'000;  // a bridge publishes its status once per second
  return view.bridge && saturated_difference(now_ns, view.bridge->time_ns) < timeout_ns;
}

ros2::Diagnostic diagnostic_of(const std::string& node, const observation::BeaconView& view,
                               const observation::BeaconView& before, TimeNs now_ns) {
  ProblemList problems;
  check_pose(view, problems);
  check_losses(view, before, problems);
  check_bridge(view, now_ns, problems);

  ros2::Diagnostic diagnostic;
  diagnostic.level = problems.level();
  diagnostic.name = fmt::format("{}: beacon {}", node, view.address);
  diagnostic.hardware_id = std::to_string(view.address);
  diagnostic.message = problems.text(fmt::format("poses at {:.1f} Hz", view.pose_rate_hz));
  Values values(diagnostic.values);
  add_pose(view, values);
  if (has_bridge(view, now_ns)) add_bridge(*view.bridge, values);
  if (view.fusion) add_counters("fusion", observation::fusion_counters, *view.fusion, values);
  return diagnostic;
}

}  // namespace sonopose::ros2::relay
