#pragma once
/// \file
/// What a consumer has seen of one beacon: counted at each sample, looked at once a second.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include "observation/latency_trace.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace sonopose::observation {

/// One second (or a whole run) of one beacon.
struct BeaconView {
  BeaconAddress address = 0;
  double window_s = 0;
  std::uint64_t poses = 0;  ///< at IMU samples
  double pose_rate_hz = 0;
  std::uint64_t predicted = 0;        ///< poses between them
  Percentiles latency;                ///< bridge's publication → here, of the poses at IMU samples
  std::array<Percentiles, 4> segments{};  ///< of each leg, as latency_segment_names
  std::optional<PoseTrace> worst;     ///< the slowest one's way
  FusedPose pose;                     ///< the latest
  std::optional<BeaconStatus> bridge;
  std::optional<FusionStatus> fusion;          ///< of the strongest one that serves
  std::vector<FusionStatus> fusions;           ///< of all that have the beacon, the strongest first
  std::uint64_t deadlines_missed = 0;          ///< of the pose stream, since the start
  std::uint64_t losses = 0;                    ///< how often the pose stream lost its last writer
  bool lost = false;                           ///< it has none now
  std::optional<double> position_error_rms_m;  ///< against the truth, where it is published
  std::optional<double> position_error_max_m;
};

/// Whether a fusion claims the beacon.
bool serves(const FusionStatus& status);

/// Whose poses consumers get of two: one that serves before one that does not, then the stronger one's.
bool serves_before(const FusionStatus& a, const FusionStatus& b);

/// Collects the poses, statuses and truth of one beacon. Not for use by several threads at once.
class BeaconObserver {
public:
  void on(const FusedPose& pose, TimeNs received_ns);
  void on(const TruthSample& truth);
  void on(const BeaconStatus& status) { bridge_ = status; }
  void on(const FusionStatus& status) { fusions_[status.fusion_id] = status; }
  void on_deadline_missed(std::uint64_t more) { deadlines_missed_ += more; }
  /// Nobody that lives writes this beacon's poses any more, until the next one comes.
  void on_pose_lost();
  void on_fusion_gone(std::uint64_t fusion_id) { fusions_.erase(fusion_id); }

  /// What was seen since the last call.
  BeaconView look(BeaconAddress address, TimeNs now_ns);

  /// What was seen in all.
  [[nodiscard]] BeaconView summary(BeaconAddress address, TimeNs now_ns) const;

private:
  /// Counts over some span of time.
  struct Span {
    TimeNs began_ns = 0;
    std::uint64_t poses = 0;
    std::uint64_t predicted = 0;
    TraceCollector traces;
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
  std::map<std::uint64_t, FusionStatus> fusions_;
  std::uint64_t losses_ = 0;
  bool lost_ = false;
  std::uint64_t deadlines_missed_ = 0;
  // Pose and truth of one instant come in any order: each waits for the other, for a while.
  std::map<TimeNs, Vector3d> truth_world_m_;
  std::map<TimeNs, Vector3d> unmatched_world_m_;
};

}  // namespace sonopose::observation
