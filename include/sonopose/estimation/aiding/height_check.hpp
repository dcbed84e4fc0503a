#pragma once
/// \file
/// Compares the height of the fixes with that at which a planar body is held.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace sonopose::estimation::aiding {

/// A height of the settings that the fixes contradict.
struct HeightProblem {
  std::string text;
  std::string remedy;
};

/// Mean height of the latest fixes above the plane of the settings. Does not allocate, but for `problem`.
class HeightCheck {
public:
  void on(const settings::PlanarSettings& settings, const UltrasonicFix& fix);

  /// Set if nearly all of the latest fixes are on one side of the plane, and far from it on average. One that
  /// is known lasts until they are clearly nearer.
  [[nodiscard]] std::optional<HeightProblem> problem(bool is_known = false) const;

private:
  settings::PlanarSettings settings_;
  std::size_t count_ = 0;
  double mean_m_ = 0;  ///< mean height above the plane
  double variance_m2_ = 0;
};

}  // namespace sonopose::estimation::aiding
