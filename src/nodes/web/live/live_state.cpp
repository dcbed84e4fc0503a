#include "web/live/live_state.hpp"

#include "web/live/rows.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace sonopose::web::live {
namespace {

/// Appends a number; null for NaN and infinity, which JSON lacks.
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

/// Replaces the last comma by the bracket.
void close(std::string& text, char bracket) {
  if (text.back() == ',') {
    text.back() = bracket;
  } else {
    text += bracket;
  }
}

void append_pose(std::string& text, const FusedPose& pose) {
  const auto row = pose_row(pose);
  const auto part = [&row](std::size_t from, std::size_t count) {
    return std::span(row).subspan(from, count);
  };
  text += "\"pose\":[";
  append_time(text, pose.time_ns);
  append(text, part(0, 9));
  append(text, part(9, 4), 7);  // the covariance
  append(text, part(13, 2));
  append(text, part(15, 1), 0);  // the status
  append(text, part(16, 1), 3);
  close(text, ']');
  text += ',';
}

void append_truth(std::string& text, const TruthSample& truth) {
  text += "\"truth\":[";
  append_time(text, truth.time_ns);
  append(text, truth_row(truth));
  close(text, ']');
  text += ',';
}

void append_fix(std::string& text, const FixReport& report) {
  const auto row = fix_row(report);
  text += '[';
  append_time(text, report.applied_time_ns);
  append_time(text, report.emission_time_ns);
  append(text, std::span(row).first(8));
  append(text, std::span(row).last(2), 0);
  close(text, ']');
  text += ',';
}

/// Text of a frame, beacon by beacon.
class Frame {
public:
  explicit Frame(TimeNs now_ns) : now_ns_(now_ns) {}

  /// Adds a beacon. Omits null and empty parts.
  void add(BeaconAddress address, const FusedPose* pose, const TruthSample* truth,
           std::span<const FixReport> fixes) {
    if (pose == nullptr && truth == nullptr && fixes.empty()) return;
    if (text_.empty()) {
      text_ = R"({"op":"frame","t":)";
      append_time(text_, now_ns_);
      text_ += "\"beacons\":[";
    }
    fmt::format_to(std::back_inserter(text_), "{{\"a\":{},", address);
    if (pose != nullptr) append_pose(text_, *pose);
    if (truth != nullptr) append_truth(text_, *truth);
    if (!fixes.empty()) {
      text_ += "\"fixes\":[";
      for (const FixReport& report : fixes) append_fix(text_, report);
      close(text_, ']');
    }
    close(text_, '}');
    text_ += ',';
  }

  /// The complete text; empty without a beacon.
  std::string text() && {
    if (text_.empty()) return {};
    close(text_, ']');
    return std::move(text_) + '}';
  }

private:
  TimeNs now_ns_;
  std::string text_;
};

}  // namespace

void LiveState::on(const FusedPose& pose) noexcept {
  const threads::Lock lock(mutex_);
  Beacon& beacon = beacons_[pose.address];
  beacon.pose = pose;
  beacon.has_pose = true;
}

void LiveState::on(const TruthSample& truth) noexcept {
  const threads::Lock lock(mutex_);
  Beacon& beacon = beacons_[truth.address];
  beacon.truth = truth;
  beacon.has_truth = true;
}

void LiveState::on(const FixReport& report) noexcept {
  if (report.hypothesis != 0) return;  // poses come from the main hypothesis
  const threads::Lock lock(mutex_);
  Beacon& beacon = beacons_[report.address];
  if (beacon.fixes.size() == max_fixes) beacon.fixes.erase(beacon.fixes.begin());
  beacon.fixes.push_back(report);
}

std::string LiveState::take_frame(TimeNs now_ns) {
  Frame frame(now_ns);
  const threads::Lock lock(mutex_);
  for (auto& [address, beacon] : beacons_) {
    frame.add(address, beacon.has_pose ? &beacon.pose : nullptr, beacon.has_truth ? &beacon.truth : nullptr,
              beacon.fixes);
    beacon.has_pose = false;
    beacon.has_truth = false;
    beacon.fixes.clear();
  }
  return std::move(frame).text();
}

std::string LiveState::latest(TimeNs now_ns) const {
  Frame frame(now_ns);
  const threads::Lock lock(mutex_);
  for (const auto& [address, beacon] : beacons_) {
    frame.add(address, beacon.pose.time_ns != 0 ? &beacon.pose : nullptr,
              beacon.truth.time_ns != 0 ? &beacon.truth : nullptr, {});
  }
  return std::move(frame).text();
}

void LiveState::forget(BeaconAddress address) {
  const threads::Lock lock(mutex_);
  beacons_.erase(address);
}

}  // namespace sonopose::web::live
