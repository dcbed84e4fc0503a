#include "observation/latency_trace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::observation {

Percentiles percentiles_of(std::vector<double> durations_s) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (durations_s.empty()) return {none, none};
  const auto at = [&durations_s](double fraction) {
    const auto last = static_cast<double>(durations_s.size() - 1);
    const auto rank = durations_s.begin() + static_cast<std::ptrdiff_t>(std::ceil(fraction * last));
    std::nth_element(durations_s.begin(), rank, durations_s.end());
    return *rank;
  };
  return {at(0.50), at(0.99)};
}

std::array<double, 4> PoseTrace::segments_s() const {
  constexpr double max_age_s = 10.0;
  const double age_s = seconds_between(sensor_ns, bridge_ns);
  return {std::abs(age_s) > max_age_s ? std::numeric_limits<double>::quiet_NaN() : age_s,
          seconds_between(bridge_ns, fusion_in_ns), seconds_between(fusion_in_ns, fusion_out_ns),
          seconds_between(fusion_out_ns, here_ns)};
}

PoseTrace trace_of(const FusedPose& pose, TimeNs here_ns) {
  return {.sequence = pose.sequence,
          .sensor_ns = pose.imu_sensor_time_ns,
          .bridge_ns = pose.imu_bridge_time_ns,
          .fusion_in_ns = pose.fusion_in_time_ns,
          .fusion_out_ns = pose.fusion_out_time_ns,
          .here_ns = here_ns};
}

void TraceCollector::add(const PoseTrace& trace) {
  if (!worst_ || trace.latency_s() > worst_->latency_s()) worst_ = trace;
  Durations durations{static_cast<float>(trace.latency_s()), {}};
  const auto segments_s = trace.segments_s();
  std::transform(segments_s.begin(), segments_s.end(), durations.segments_s.begin(),
                 [](double segment_s) { return static_cast<float>(segment_s); });
  add(durations);
}

void TraceCollector::add(const TraceCollector& other) {
  if (other.worst_ && (!worst_ || other.worst_->latency_s() > worst_->latency_s())) worst_ = other.worst_;
  for (const Durations& durations : other.durations_) add(durations);
  seen_ += other.seen_ - other.durations_.size();  // those without a kept sample
}

void TraceCollector::add(const Durations& durations) {
  constexpr std::size_t max_samples = 16'384;
  ++seen_;
  if (durations_.size() < max_samples) {
    durations_.push_back(durations);
    return;
  }
  // Reservoir sampling: keeps each trace with the same probability, max_samples / seen_.
  const std::size_t index = std::uniform_int_distribution<std::size_t>(0, seen_ - 1)(random_);
  if (index < max_samples) durations_[index] = durations;
}

void TraceCollector::clear() {
  durations_.clear();
  seen_ = 0;
  worst_.reset();
}

Percentiles TraceCollector::latency() const {
  std::vector<double> latencies_s;
  latencies_s.reserve(durations_.size());
  for (const Durations& durations : durations_) latencies_s.push_back(durations.latency_s);
  return percentiles_of(std::move(latencies_s));
}

std::array<Percentiles, 4> TraceCollector::segments() const {
  std::array<Percentiles, 4> segments{};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    std::vector<double> durations_s;
    durations_s.reserve(durations_.size());
    for (const Durations& durations : durations_) {
      if (!std::isnan(durations.segments_s[i])) durations_s.push_back(durations.segments_s[i]);
    }
    segments[i] = percentiles_of(std::move(durations_s));
  }
  return segments;
}

}  // namespace sonopose::observation
