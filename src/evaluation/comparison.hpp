#pragma once
/// \file
/// A run's errors beside those of what there is without a fusion, at the same moments.

#include "evaluation/baseline.hpp"
#include "evaluation/score.hpp"

#include <span>
#include <vector>

namespace sonopose::evaluation {

/// Takes events' fixes and the poses between them, in the order of arrival.
class Comparison {
public:
  /// Poses before `from_ns` are not scored. `truth`, in ascending time, must outlive this.
  Comparison(std::span<const TruthSample> truth, TimeNs from_ns)
      : scorer_(truth, from_ns), truth_(truth), from_ns_(from_ns) {}

  void add(const UltrasonicFix& fix) { baseline_.on(fix); }
  void add(const FusedPose& pose);

  [[nodiscard]] Score fused() const { return scorer_.score(); }
  [[nodiscard]] ErrorSummary last_fix_m() const { return summarise(last_fix_m_); }
  [[nodiscard]] ErrorSummary extrapolated_m() const { return summarise(extrapolated_m_); }

private:
  Scorer scorer_;
  TruthTrack truth_;
  TimeNs from_ns_;
  Baseline baseline_;
  std::vector<double> last_fix_m_;
  std::vector<double> extrapolated_m_;
};

}  // namespace sonopose::evaluation
