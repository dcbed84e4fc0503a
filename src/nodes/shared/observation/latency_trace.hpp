#pragma once
/// \file
/// Latency from a measurement to the reception of its pose, by segment.

#include <sonopose/samples/pose.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

namespace sonopose::observation {

/// Percentiles of a set of durations; NaN for an empty set.
struct Percentiles {
  double p50_s;
  double p99_s;
};
Percentiles percentiles_of(std::vector<double> durations_s);

/// Segments from the measurement to the reception of a pose, in order.
inline constexpr std::array<std::string_view, 4> latency_segment_names{"sensor_to_bridge", "bridge_to_fusion",
                                                                       "in_fusion", "fusion_to_here"};

/// Timestamps of one pose, host clock (ns). A segment between two machines includes the difference of their
/// clocks.
struct PoseTrace {
  std::uint64_t sequence = 0;  ///< number of the IMU sample
  TimeNs sensor_ns = 0;        ///< measured by the sensor
  TimeNs bridge_ns = 0;        ///< sample published by the bridge
  TimeNs fusion_in_ns = 0;     ///< sample received by the fusion
  TimeNs fusion_out_ns = 0;    ///< pose published by the fusion
  TimeNs here_ns = 0;          ///< pose received by this process

  /// Durations in the order of `latency_segment_names`. That from the sensor is NaN if its stamp is of
  /// another time, as in a recording that is played.
  [[nodiscard]] std::array<double, 4> segments_s() const;
  /// Latency that the system adds, from the bridge to here.
  [[nodiscard]] double latency_s() const { return seconds_between(bridge_ns, here_ns); }
};

/// Trace of a pose that was received at `here_ns`.
PoseTrace trace_of(const FusedPose& pose, TimeNs here_ns);

/// Collects traces over a time span. Keeps a uniform random sample of at most 16,384, and always the worst.
class TraceCollector {
public:
  void add(const PoseTrace& trace);
  /// Adds the traces of another collector.
  void add(const TraceCollector& other);
  /// Forgets everything, but keeps the memory.
  void clear();

  [[nodiscard]] Percentiles latency() const;
  /// Percentiles in the order of `latency_segment_names`.
  [[nodiscard]] std::array<Percentiles, 4> segments() const;
  /// Trace with the largest latency; empty before the first trace.
  [[nodiscard]] const std::optional<PoseTrace>& worst() const { return worst_; }

private:
  struct Durations {
    float latency_s;
    std::array<float, 4> segments_s;
  };
  void add(const Durations& durations);

  std::vector<Durations> durations_;
  std::size_t seen_ = 0;
  std::minstd_rand random_;
  std::optional<PoseTrace> worst_;
};

}  // namespace sonopose::observation
