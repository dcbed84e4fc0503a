#pragma once
/// \file
/// Where the time goes between a measurement and the arrival of its pose.

#include <sonopose/samples/pose.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

namespace sonopose::observation {

/// Percentiles of a set of durations. NaN where there are none.
struct Percentiles {
  double p50_s;
  double p99_s;
};
Percentiles percentiles_of(std::vector<double> durations_s);

/// The segments of a pose's way, in their order.
inline constexpr std::array<std::string_view, 4> latency_segment_names{"sensor_to_bridge", "bridge_to_fusion",
                                                           "in_fusion", "fusion_to_here"};

/// The way of one pose. Between two machines a leg is wrong by as much as their clocks differ.
struct PoseTrace {
  std::uint64_t sequence = 0;  ///< of the IMU sample
  TimeNs sensor_ns = 0;        ///< measured,
  TimeNs bridge_ns = 0;        ///< published by the bridge,
  TimeNs fusion_in_ns = 0;     ///< taken by the fusion,
  TimeNs fusion_out_ns = 0;    ///< its pose written,
  TimeNs here_ns = 0;          ///< and received here

  /// As long as `latency_segment_names`.
  [[nodiscard]] std::array<double, 4> legs_s() const;
  /// From the bridge to here: what the system adds.
  [[nodiscard]] double latency_s() const { return seconds_between(bridge_ns, here_ns); }
};

/// The trace that a pose brings along, which arrived at `here_ns`.
PoseTrace trace_of(const FusedPose& pose, TimeNs here_ns);

/// Collects traces over some span of time. Of more than 16,384 it keeps a fair sample, and the worst.
class TraceCollector {
public:
  void add(const PoseTrace& trace);

  [[nodiscard]] Percentiles latency() const;
  /// Of each leg, as `latency_segment_names`.
  [[nodiscard]] std::array<Percentiles, 4> segments() const;
  /// The one with the greatest latency; empty where there is none.
  [[nodiscard]] const std::optional<PoseTrace>& worst() const { return worst_; }

private:
  struct Durations {
    float latency_s;
    std::array<float, 4> legs_s;
  };
  std::vector<Durations> durations_;
  std::size_t seen_ = 0;
  std::minstd_rand random_;
  std::optional<PoseTrace> worst_;
};

}  // namespace sonopose::observation
