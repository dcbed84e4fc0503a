#include <sonopose/nodes/beacon_view.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::nodes {
namespace {

/// Remembers at most this many; more than a second at any rate.
constexpr std::size_t most_waiting = 2048;
/// A run's latencies: over an hour at 250 Hz; what comes after that does not count.
constexpr std::size_t most_latencies = 1'000'000;

void remember(std::map<TimeNs, Vector3d>& waiting, TimeNs time_ns, const Vector3d& position_world_m) {
  waiting[time_ns] = position_world_m;
  if (waiting.size() > most_waiting) waiting.erase(waiting.begin());
}

/// Takes out what waits for `time_ns`.
std::optional<Vector3d> taken(std::map<TimeNs, Vector3d>& waiting, TimeNs time_ns) {
  const auto node = waiting.extract(time_ns);
  if (node.empty()) return std::nullopt;
  return node.mapped();
}

}  // namespace

Percentiles percentiles_of(std::vector<double> durations_s) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (durations_s.empty()) return {none, none};
  const auto at = [&durations_s](double share) {
    const auto last = static_cast<double>(durations_s.size() - 1);
    const auto place = durations_s.begin() + static_cast<std::ptrdiff_t>(std::ceil(share * last));
    std::nth_element(durations_s.begin(), place, durations_s.end());
    return *place;
  };
  return {at(0.50), at(0.99)};
}

void BeaconWatch::on(const FusedPose& pose, TimeNs received_ns) {
  const double latency_s = seconds_between(pose.imu_bridge_time_ns, received_ns);
  for (Span* span : {&window_, &whole_}) {
    if (span->began_ns == 0) span->began_ns = received_ns;
    ++span->poses;
    if (span->latencies_s.size() < most_latencies) span->latencies_s.push_back(latency_s);
  }
  latest_ = pose;
  if ((pose.status & status_initialising) != 0U) return;
  if (const auto truth_world_m = taken(truth_world_m_, pose.time_ns)) {
    compare(pose.position_world_m, *truth_world_m);
  } else {
    remember(unmatched_world_m_, pose.time_ns, pose.position_world_m);
  }
}

void BeaconWatch::on(const TruthSample& truth) {
  if (const auto fused_world_m = taken(unmatched_world_m_, truth.time_ns)) {
    compare(*fused_world_m, truth.position_world_m);
  } else {
    remember(truth_world_m_, truth.time_ns, truth.position_world_m);
  }
}

void BeaconWatch::compare(const Vector3d& fused_world_m, const Vector3d& true_world_m) {
  const double error_m = (fused_world_m - true_world_m).norm();
  if (!std::isfinite(error_m)) return;
  for (Span* span : {&window_, &whole_}) {
    ++span->errors;
    span->squared_error_sum_m2 += error_m * error_m;
    span->error_max_m = std::max(span->error_max_m, error_m);
  }
}

BeaconView BeaconWatch::view_of(const Span& span, BeaconAddress address, TimeNs now_ns) const {
  BeaconView view;
  view.address = address;
  view.window_s = span.began_ns == 0 ? 0.0 : seconds_between(span.began_ns, now_ns);
  view.poses = span.poses;
  view.pose_rate_hz = view.window_s > 0.0 ? static_cast<double>(span.poses) / view.window_s : 0.0;
  view.latency = percentiles_of(span.latencies_s);
  view.pose = latest_;
  view.bridge = bridge_;
  view.fusion = fusion_;
  view.deadlines_missed = deadlines_missed_;
  if (span.errors > 0) {
    view.position_error_rms_m = std::sqrt(span.squared_error_sum_m2 / static_cast<double>(span.errors));
    view.position_error_max_m = span.error_max_m;
  }
  return view;
}

BeaconView BeaconWatch::look(BeaconAddress address, TimeNs now_ns) {
  const BeaconView view = view_of(window_, address, now_ns);
  window_ = {};
  window_.began_ns = now_ns;
  return view;
}

BeaconView BeaconWatch::summary(BeaconAddress address, TimeNs now_ns) const {
  return view_of(whole_, address, now_ns);
}

}  // namespace sonopose::nodes
