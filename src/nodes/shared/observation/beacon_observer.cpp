#include "observation/beacon_observer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonopose::observation {
bool serves(const FusionStatus& status) {
  return status.role == FusionRole::sole || status.role == FusionRole::serving;
}

bool serves_before(const FusionStatus& a, const FusionStatus& b) {
  if (serves(a) != serves(b)) return serves(a);
  return a.strength > b.strength;
}

void BeaconObserver::on(const FusedPose& pose, TimeNs received_ns) {
  const bool is_predicted = (pose.status & status_predicted) != 0U;
  if (first_ns_ == 0) first_ns_ = received_ns;
  if (window_.began_ns == 0) window_.began_ns = received_ns;
  ++(is_predicted ? window_.predicted : window_.poses);
  if (!is_predicted) window_.traces.add(trace_of(pose, received_ns));
  latest_ = pose;
  lost_ = false;
  if (is_predicted) return;
  if ((pose.status & status_initialising) != 0U) return;
  if (const auto truth_world_m = unmatched_truths_.extract(pose.time_ns)) {
    compare(pose.position_world_m, *truth_world_m);
  } else {
    unmatched_poses_.store(pose.time_ns, pose.position_world_m);
  }
}

void BeaconObserver::on(const TruthSample& truth) {
  if (const auto fused_world_m = unmatched_poses_.extract(truth.time_ns)) {
    compare(*fused_world_m, truth.position_world_m);
  } else {
    unmatched_truths_.store(truth.time_ns, truth.position_world_m);
  }
}

void BeaconObserver::on_pose_lost() {
  if (!lost_) ++losses_;
  lost_ = true;
}

void BeaconObserver::compare(const Vector3d& fused_world_m, const Vector3d& truth_world_m) {
  const double error_m = (fused_world_m - truth_world_m).norm();
  if (!std::isfinite(error_m)) return;
  ++window_.errors;
  window_.squared_error_sum_m2 += error_m * error_m;
  window_.error_max_m = std::max(window_.error_max_m, error_m);
}

void BeaconObserver::Span::add(const Span& next) {
  poses += next.poses;
  predicted += next.predicted;
  traces.add(next.traces);
  errors += next.errors;
  squared_error_sum_m2 += next.squared_error_sum_m2;
  error_max_m = std::max(error_max_m, next.error_max_m);
}

void BeaconObserver::Span::restart(TimeNs now_ns) {
  traces.clear();
  *this = {.began_ns = now_ns, .traces = std::move(traces)};
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
  BeaconView view = view_of(window_, address, now_ns);
  before_.add(window_);
  window_.restart(now_ns);
  return view;
}

BeaconView BeaconObserver::summary(BeaconAddress address, TimeNs now_ns) const {
  Span whole = before_;
  whole.add(window_);
  whole.began_ns = first_ns_;
  return view_of(whole, address, now_ns);
}

}  // namespace sonopose::observation
