#include "observation/beacon_observer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace sonopose::observation {
namespace {

/// More than one second of samples at any supported rate.
constexpr std::size_t max_unmatched = 2048;

void store(std::map<TimeNs, Vector3d>& unmatched, TimeNs time_ns, const Vector3d& position_world_m) {
  unmatched.erase(unmatched.upper_bound(time_ns), unmatched.end());  // the clock has stepped back
  unmatched[time_ns] = position_world_m;
  if (unmatched.size() > max_unmatched) unmatched.erase(unmatched.begin());
}

/// Removes and returns the position of `time_ns`, and removes all earlier ones: both streams are in order, so
/// what they would match was lost.
std::optional<Vector3d> extract(std::map<TimeNs, Vector3d>& unmatched, TimeNs time_ns) {
  const auto found = unmatched.find(time_ns);
  if (found == unmatched.end()) return std::nullopt;
  const Vector3d position_world_m = found->second;
  unmatched.erase(unmatched.begin(), std::next(found));
  return position_world_m;
}

}  // namespace

bool serves(const FusionStatus& status) {
  return status.role == FusionRole::sole || status.role == FusionRole::serving;
}

bool serves_before(const FusionStatus& a, const FusionStatus& b) {
  if (serves(a) != serves(b)) return serves(a);
  return a.strength > b.strength;
}

void BeaconObserver::on(const FusedPose& pose, TimeNs received_ns) {
  const bool is_predicted = (pose.status & status_predicted) != 0U;
  for (Span* span : {&window_, &whole_}) {
    if (span->began_ns == 0) span->began_ns = received_ns;
    ++(is_predicted ? span->predicted : span->poses);
    if (!is_predicted) span->traces.add(trace_of(pose, received_ns));
  }
  latest_ = pose;
  lost_ = false;
  if (is_predicted) return;
  if ((pose.status & status_initialising) != 0U) return;
  if (const auto truth_world_m = extract(unmatched_truths_world_m_, pose.time_ns)) {
    compare(pose.position_world_m, *truth_world_m);
  } else {
    store(unmatched_poses_world_m_, pose.time_ns, pose.position_world_m);
  }
}

void BeaconObserver::on(const TruthSample& truth) {
  if (const auto fused_world_m = extract(unmatched_poses_world_m_, truth.time_ns)) {
    compare(*fused_world_m, truth.position_world_m);
  } else {
    store(unmatched_truths_world_m_, truth.time_ns, truth.position_world_m);
  }
}

void BeaconObserver::on_pose_lost() {
  if (!lost_) ++losses_;
  lost_ = true;
}

void BeaconObserver::compare(const Vector3d& fused_world_m, const Vector3d& truth_world_m) {
  const double error_m = (fused_world_m - truth_world_m).norm();
  if (!std::isfinite(error_m)) return;
  for (Span* span : {&window_, &whole_}) {
    ++span->errors;
    span->squared_error_sum_m2 += error_m * error_m;
    span->error_max_m = std::max(span->error_max_m, error_m);
  }
}

BeaconView BeaconObserver::view_of(const Span& span, BeaconAddress address, TimeNs now_ns) const {
  BeaconView view;
  view.address = address;
  view.window_s = span.began_ns == 0 ? 0.0 : seconds_between(span.began_ns, now_ns);
  view.poses = span.poses;
  view.pose_rate_hz = view.window_s > 0.0 ? static_cast<double>(span.poses) / view.window_s : 0.0;
  view.predicted = span.predicted;
  view.latency = span.traces.latency();
  view.segments = span.traces.segments();
  view.worst = span.traces.worst();
  view.pose = latest_;
  view.bridge = bridge_;
  for (const auto& entry : fusions_) view.fusions.push_back(entry.second);
  std::sort(view.fusions.begin(), view.fusions.end(), serves_before);
  if (!view.fusions.empty()) {
    view.fusion = view.fusions.front();
    const auto estimate = estimates_.find(view.fusion->fusion_id);
    if (estimate != estimates_.end()) view.estimate = estimate->second;
  }
  view.report = report_;
  view.losses = losses_;
  view.lost = lost_;
  view.deadlines_missed = deadlines_missed_;
  if (span.errors > 0) {
    view.position_error_rms_m = std::sqrt(span.squared_error_sum_m2 / static_cast<double>(span.errors));
    view.position_error_max_m = span.error_max_m;
  }
  return view;
}

BeaconView BeaconObserver::take_window(BeaconAddress address, TimeNs now_ns) {
  const BeaconView view = view_of(window_, address, now_ns);
  window_ = {};
  window_.began_ns = now_ns;
  return view;
}

BeaconView BeaconObserver::summary(BeaconAddress address, TimeNs now_ns) const {
  return view_of(whole_, address, now_ns);
}

}  // namespace sonopose::observation
