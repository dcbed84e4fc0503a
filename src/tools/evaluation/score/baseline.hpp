#pragma once
/// \file
/// Position estimates without fusion, for comparison: the latest fix, and its extrapolation with the velocity
/// between the last two fixes.

#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::evaluation {

class Baseline {
public:
  /// Adds a fix. Ignores one that was measured before the latest.
  void on(const UltrasonicFix& fix);

  /// The latest fix, as a program without an IMU would show it; empty before the first fix.
  [[nodiscard]] std::optional<Vector3d> last_fix() const;

  /// The latest fix extrapolated to `time_ns` with the velocity between the last two fixes. Not extrapolated
  /// if they are more than half a second apart.
  [[nodiscard]] std::optional<Vector3d> extrapolated(TimeNs time_ns) const;

private:
  std::optional<UltrasonicFix> latest_;
  std::optional<UltrasonicFix> before_;
};

}  // namespace sonopose::evaluation
