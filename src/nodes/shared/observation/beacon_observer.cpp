#include "observation/beacon_observer.hpp"

#include <sonopose/geometry/rotation.hpp>

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
  watch_tilt(pose, received_ns);
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

void BeaconObserver::watch_tilt(const FusedPose& pose, TimeNs received_ns) {
  constexpr double max_tilt_rad = 45.0 * geometry::radians_per_degree;  // as the doctor's
  const double up = (pose.q_body_to_world * Vector3d::UnitZ()).z();
  tilt_rad_ = std::acos(std::clamp(up, -1.0, 1.0));
  if ((pose.status & status_initialising) != 0U || !(tilt_rad_ > max_tilt_rad)) {
    tilted_since_ns_ = 0;
  } else if (tilted_since_ns_ == 0) {
    tilted_since_ns_ = received_ns;
  }
  tilted_until_ns_ = received_ns;
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
  constexpr TimeNs brief_tilt_ns = 5'000'000'000;  // a manoeuvre is shorter
  if (tilted_since_ns_ != 0 && tilted_until_ns_ - tilted_since_ns_ >= brief_tilt_ns) {
    view.wrong_tilt_rad = tilt_rad_;
  }
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
