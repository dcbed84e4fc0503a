#pragma once
/// \file
/// What a consumer has seen of one beacon: counted at each sample, looked at once a second.

#include <sonopose/core/pose.hpp>
#include <sonopose/core/samples.hpp>
#include <sonopose/core/status.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace sonopose::nodes {

/// Percentiles of a set of durations. NaN where there are none.
struct Percentiles {
  double p50_s;
  double p99_s;
};
Percentiles percentiles_of(std::vector<double> durations_s);

/// One second (or a whole run) of one beacon.
struct BeaconView {
  BeaconAddress address = 0;
  double window_s = 0;
  std::uint64_t poses = 0;
  double pose_rate_hz = 0;
  Percentiles latency;  ///< bridge's publication → here, of the poses
  FusedPose pose;       ///< the latest
  std::optional<BeaconStatus> bridge;
  std::optional<FusionStatus> fusion;
  std::uint64_t deadlines_missed = 0;          ///< of the pose stream, since the start
  std::optional<double> position_error_rms_m;  ///< against the truth, where it is published
  std::optional<double> position_error_max_m;
};

/// Collects the poses, statuses and truth of one beacon. Not for use by several threads at once.
class BeaconWatch {
public:
  void on(const FusedPose& pose, TimeNs received_ns);
  void on(const TruthSample& truth);
  void on(const BeaconStatus& status) { bridge_ = status; }
  void on(const FusionStatus& status) { fusion_ = status; }
  void on_deadline_missed(std::uint64_t more) { deadlines_missed_ += more; }

  /// What was seen since the last call.
  BeaconView look(BeaconAddress address, TimeNs now_ns);

  /// What was seen in all.
  [[nodiscard]] BeaconView summary(BeaconAddress address, TimeNs now_ns) const;

private:
  /// Counts over some span of time.
  struct Span {
    TimeNs began_ns = 0;
    std::uint64_t poses = 0;
    std::vector<double> latencies_s;
    std::uint64_t errors = 0;
    double squared_error_sum_m2 = 0;
    double error_max_m = 0;
  };

  void compare(const Vector3d& fused_world_m, const Vector3d& true_world_m);
  [[nodiscard]] BeaconView view_of(const Span& span, BeaconAddress address, TimeNs now_ns) const;

  Span window_;
  Span whole_;
  FusedPose latest_;
  std::optional<BeaconStatus> bridge_;
  std::optional<FusionStatus> fusion_;
  std::uint64_t deadlines_missed_ = 0;
  // Pose and truth of one instant come in any order: each waits for the other, for a while.
  std::map<TimeNs, Vector3d> truth_world_m_;
  std::map<TimeNs, Vector3d> unmatched_world_m_;
};

}  // namespace sonopose::nodes
