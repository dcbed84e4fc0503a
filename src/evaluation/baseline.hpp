#pragma once
/// \file
/// What there is without a fusion, to compare it with: the latest fix, and the latest fix carried on at the
/// velocity between the last two.

#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::evaluation {

class Baseline {
public:
  /// Takes note of a fix; one that was measured before the latest is left out.
  void on(const UltrasonicFix& fix);

  /// The latest fix, as a program without an IMU would show it; empty before the first.
  [[nodiscard]] std::optional<Vector3d> last_fix() const;

  /// The latest fix moved on to `time_ns` by the velocity between the last two; that fix itself where they
  /// are more than half a second apart.
  [[nodiscard]] std::optional<Vector3d> extrapolated(TimeNs time_ns) const;

private:
  std::optional<UltrasonicFix> latest_;
  std::optional<UltrasonicFix> before_;
};

}  // namespace sonopose::evaluation
