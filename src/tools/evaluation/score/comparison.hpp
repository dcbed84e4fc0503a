#pragma once
/// \file
/// Compares the errors of a run with those of the fixes alone, at the same times.

#include "evaluation/score/baseline.hpp"
#include "evaluation/score/score.hpp"

#include <span>
#include <vector>

namespace sonopose::evaluation {

/// Takes fixes and poses in the order of arrival.
class Comparison {
public:
  /// Poses before `from_ns` are not scored. `truth`, in ascending time, must outlive this object.
  Comparison(std::span<const TruthSample> truth, TimeNs from_ns)
      : scorer_(truth, from_ns), truth_(truth), from_ns_(from_ns) {}

  void add(const UltrasonicFix& fix) { baseline_.on(fix); }
  void add(const FusedPose& pose);

  [[nodiscard]] Score fused() const { return scorer_.score(); }
  [[nodiscard]] ErrorSummary last_fix_m() const { return error_summary_of(last_fix_m_); }
  [[nodiscard]] ErrorSummary extrapolated_m() const { return error_summary_of(extrapolated_m_); }

private:
  Scorer scorer_;
  TruthTrack truth_;
  TimeNs from_ns_;
  TimeNs before_ns_ = 0;  ///< time of the pose before; 0 without one
  Baseline baseline_;
  std::vector<double> last_fix_m_;
  std::vector<double> extrapolated_m_;
};

}  // namespace sonopose::evaluation
