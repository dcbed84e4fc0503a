#pragma once
/// \file
/// Observations of one beacon by a consumer: updated with each sample, read once per second.

#include "observation/latency_trace.hpp"
#include "observation/unmatched_positions.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace sonopose::observation {

/// Observations of one beacon over a window of one second, or over a whole run.
struct BeaconView {
  BeaconAddress address = 0;
  double window_s = 0;
  std::uint64_t poses = 0;  ///< number of poses at IMU samples
  double pose_rate_hz = 0;
  std::uint64_t predicted = 0;  ///< number of poses between IMU samples
  Percentiles latency;          ///< publication by the bridge → reception here, for poses at IMU samples
  std::array<Percentiles, 4> segments{};  ///< in the order of latency_segment_names
  std::optional<PoseTrace> worst;         ///< trace of the pose with the largest latency
  FusedPose pose;                         ///< latest pose
  std::optional<BeaconStatus> bridge;
  std::optional<FusionStatus> fusion;          ///< strongest fusion that serves the beacon
  std::vector<FusionStatus> fusions;           ///< all fusions of the beacon, ordered by serves_before
  std::optional<Estimate> estimate;            ///< from the same fusion as `fusion`
  std::optional<FixReport> report;             ///< report on the latest fix, if the observer receives reports
  std::uint64_t deadlines_missed = 0;          ///< deadlines of the pose stream, since the start
  std::uint64_t losses = 0;                    ///< times that the pose stream lost its last writer
  bool lost = false;                           ///< the pose stream has no writer
  std::optional<double> wrong_tilt_rad;        ///< tilt of the body, if over 45° for the last 5 s
  std::optional<double> position_error_rms_m;  ///< error against the ground truth, if published
  std::optional<double> position_error_max_m;
};

/// True if the fusion publishes poses of the beacon (sole or serving).
bool serves(const FusionStatus& status);

/// True if `a` precedes: it serves and `b` does not, or else it is stronger.
bool serves_before(const FusionStatus& a, const FusionStatus& b);

/// Collects the poses, statuses and ground truth of one beacon. Not thread-safe.
class BeaconObserver {
public:
  void on(const FusedPose& pose, TimeNs received_ns);
  void on(const TruthSample& truth);
  void on(const BeaconStatus& status) { bridge_ = status; }
  void on(const FusionStatus& status) { fusions_[status.fusion_id] = status; }
  void on(const Estimate& estimate) { estimates_[estimate.fusion_id] = estimate; }
  void on(const FixReport& report) {
    if (report.hypothesis == 0) report_ = report;  // poses come from the main hypothesis
  }
  void on_deadline_missed(std::uint64_t count) { deadlines_missed_ += count; }
  /// Reports that the pose stream has lost its last writer. The next pose ends this state.
  void on_pose_lost();
  void on_fusion_gone(std::uint64_t fusion_id) {
    fusions_.erase(fusion_id);
    estimates_.erase(fusion_id);
  }
  void on_estimate_gone(std::uint64_t fusion_id) { estimates_.erase(fusion_id); }

  /// Number of poses at IMU samples since the start.
  [[nodiscard]] std::uint64_t poses() const { return before_.poses + window_.poses; }

  /// Returns the observations since the last call; starts a new window.
  BeaconView take_window(BeaconAddress address, TimeNs now_ns);

  /// Observations since the start.
  [[nodiscard]] BeaconView summary(BeaconAddress address, TimeNs now_ns) const;

private:
  /// Counts over one time span.
  struct Span {
    TimeNs began_ns = 0;
    std::uint64_t poses = 0;
    std::uint64_t predicted = 0;
    TraceCollector traces;
    std::uint64_t errors = 0;
    double squared_error_sum_m2 = 0;
    double error_max_m = 0;

    void add(const Span& next);
    void restart(TimeNs now_ns);
  };

  void watch_tilt(const FusedPose& pose, TimeNs received_ns);
  void compare(const Vector3d& fused_world_m, const Vector3d& truth_world_m);
  [[nodiscard]] BeaconView view_of(const Span& span, BeaconAddress address, TimeNs now_ns) const;

  Span window_;
  Span before_;          ///< all earlier windows: each sample is counted once
  TimeNs first_ns_ = 0;  ///< reception time of the first pose
  FusedPose latest_;
  std::optional<BeaconStatus> bridge_;
  std::map<std::uint64_t, FusionStatus> fusions_;
  std::map<std::uint64_t, Estimate> estimates_;
  std::optional<FixReport> report_;
  std::uint64_t losses_ = 0;
  bool lost_ = false;
  TimeNs tilted_since_ns_ = 0;  ///< 0: not tilted
  TimeNs tilted_until_ns_ = 0;
  double tilt_rad_ = 0;
  std::uint64_t deadlines_missed_ = 0;
  // Pose and truth of one instant arrive in any order; each waits for the other.
  UnmatchedPositions unmatched_truths_;
  UnmatchedPositions unmatched_poses_;
};

}  // namespace sonopose::observation
