#include "observation/latency_trace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::observation {

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

std::array<double, 4> PoseTrace::legs_s() const {
  return {seconds_between(sensor_ns, bridge_ns), seconds_between(bridge_ns, fusion_in_ns),
          seconds_between(fusion_in_ns, fusion_out_ns), seconds_between(fusion_out_ns, here_ns)};
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
  constexpr std::size_t most = 16'384;
  if (!worst_ || trace.latency_s() > worst_->latency_s()) worst_ = trace;
  ++seen_;
  Durations durations{static_cast<float>(trace.latency_s()), {}};
  const auto legs_s = trace.legs_s();
  std::transform(legs_s.begin(), legs_s.end(), durations.legs_s.begin(),
                 [](double leg_s) { return static_cast<float>(leg_s); });
  if (durations_.size() < most) {
    durations_.push_back(durations);
    return;
  }
  // Reservoir sampling: each trace stays with the same probability, most / seen_.
  const std::size_t place = std::uniform_int_distribution<std::size_t>(0, seen_ - 1)(random_);
  if (place < most) durations_[place] = durations;
}

Percentiles TraceCollector::latency() const {
  std::vector<double> latencies_s;
  latencies_s.reserve(durations_.size());
  for (const Durations& durations : durations_) latencies_s.push_back(durations.latency_s);
  return percentiles_of(std::move(latencies_s));
}

std::array<Percentiles, 4> TraceCollector::segments() const {
  std::array<Percentiles, 4> segments{};
  for (std::size_t leg = 0; leg < segments.size(); ++leg) {
    std::vector<double> lengths_s;
    lengths_s.reserve(durations_.size());
    for (const Durations& durations : durations_) lengths_s.push_back(durations.legs_s[leg]);
    segments[leg] = percentiles_of(std::move(lengths_s));
  }
  return segments;
}

}  // namespace sonopose::observation
