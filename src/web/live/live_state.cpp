#include "web/live/live_state.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <span>

namespace sonopose::web::live {
namespace {

/// JSON has no NaN and no infinity: null.
void append(std::string& text, double value, int digits) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), "{:.{}f},", value, digits);
  } else {
    text += "null,";
  }
}

void append(std::string& text, std::span<const double> values, int digits = 4) {
  for (const double value : values) append(text, value, digits);
}

void append_time(std::string& text, TimeNs time_ns) {
  append(text, 1e-9 * static_cast<double>(time_ns), 4);
}

/// Replaces the last comma.
void close(std::string& text, char bracket) {
  if (text.back() == ',') {
    text.back() = bracket;
  } else {
    text += bracket;
  }
}

double unknown_if_negative(double variance) {
  return variance >= 0 ? variance : std::nan("");
}

void append_pose(std::string& text, const FusedPose& pose) {
  const bool has_position = (pose.status & status_initialising) == 0;
  const Vector3d position = has_position ? pose.position_world_m : Vector3d::Constant(std::nan(""));
  const Vector3d& velocity = pose.velocity_world_mps;
  const auto euler = geometry::euler_angles_of(pose.q_body_to_world);
  const auto& covariance = pose.pose_covariance;
  const bool known = covariance.at(0, 0) >= 0;
  const double unknown = std::nan("");
  text += "\"pose\":[";
  append_time(text, pose.time_ns);
  append(text, std::array{position.x(), position.y(), position.z(), euler.roll_rad, euler.pitch_rad,
                          euler.yaw_rad, velocity.x(), velocity.y(), velocity.z()});
  append(text,
         std::array{known ? covariance.at(0, 0) : unknown, known ? covariance.at(0, 1) : unknown,
                    known ? covariance.at(1, 1) : unknown, unknown_if_negative(covariance.at(2, 2))},
         7);
  append(text, std::array{std::sqrt(unknown_if_negative(covariance.at(5, 5))), pose.trust});
  fmt::format_to(std::back_inserter(text), "{},", pose.status);
  append(text, pose.since_valid_fix_s, 3);
  close(text, ']');
  text += ',';
}

void append_truth(std::string& text, const TruthSample& truth) {
  text += "\"truth\":[";
  append_time(text, truth.time_ns);
  append(text, std::array{truth.position_world_m.x(), truth.position_world_m.y(), truth.position_world_m.z(),
                          geometry::yaw_of(truth.q_body_to_world)});
  close(text, ']');
  text += ',';
}

void append_fix(std::string& text, const FixReport& report) {
  text += '[';
  append_time(text, report.applied_time_ns);
  append_time(text, report.emission_time_ns);
  const Vector3d& position = report.position_world_m;
  const Vector3d& innovation = report.innovation_world_m;
  append(text, std::array{position.x(), position.y(), position.z(), innovation.x(), innovation.y(),
                          innovation.z(), report.test_ratio.value_or(std::nan("")), report.weight});
  fmt::format_to(std::back_inserter(text), "{}],", report.flags);
}

}  // namespace

LiveState::Beacon& LiveState::beacon(BeaconAddress address) {
  return beacons_.try_emplace(address, address).first->second;
}

void LiveState::on(const FusedPose& pose) noexcept {
  const std::lock_guard lock(mutex_);
  Beacon& beacon = this->beacon(pose.address);
  beacon.pose = pose;
  beacon.has_pose = true;
  beacon.watch.on(pose, beacon.pending);
}

void LiveState::on(const TruthSample& truth) noexcept {
  const std::lock_guard lock(mutex_);
  Beacon& beacon = this->beacon(truth.address);
  beacon.truth = truth;
  beacon.has_truth = true;
}

void LiveState::on(const FixReport& report) noexcept {
  if (report.hypothesis != 0) return;  // the poses are of the main one
  const std::lock_guard lock(mutex_);
  Beacon& beacon = this->beacon(report.address);
  beacon.watch.on(report, beacon.pending);
  if (beacon.fixes.size() < max_fixes) beacon.fixes.push_back(report);
}

std::string LiveState::take_frame(TimeNs now_ns) {
  std::string text;
  const std::lock_guard lock(mutex_);
  for (auto& [address, beacon] : beacons_) {
    if (!beacon.has_pose && !beacon.has_truth && beacon.fixes.empty()) continue;
    if (text.empty()) {
      text = R"({"op":"frame","t":)";
      append_time(text, now_ns);
      text += "\"beacons\":[";
    }
    fmt::format_to(std::back_inserter(text), "{{\"a\":{},", address);
    if (beacon.has_pose) append_pose(text, beacon.pose);
    if (beacon.has_truth) append_truth(text, beacon.truth);
    if (!beacon.fixes.empty()) {
      text += "\"fixes\":[";
      for (const FixReport& report : beacon.fixes) append_fix(text, report);
      close(text, ']');
    }
    close(text, '}');
    text += ',';
    beacon.has_pose = false;
    beacon.has_truth = false;
    beacon.fixes.clear();
  }
  if (text.empty()) return text;
  close(text, ']');
  text += '}';
  return text;
}

std::vector<std::pair<BeaconAddress, transitions::Pending>> LiveState::take_transitions() {
  std::vector<std::pair<BeaconAddress, transitions::Pending>> taken;
  const std::lock_guard lock(mutex_);
  for (auto& [address, beacon] : beacons_) {
    if (beacon.pending.empty()) continue;
    taken.emplace_back(address, beacon.pending);
    beacon.pending.clear();
  }
  return taken;
}

void LiveState::forget(BeaconAddress address) {
  const std::lock_guard lock(mutex_);
  beacons_.erase(address);
}

}  // namespace sonopose::web::live
