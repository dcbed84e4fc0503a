#pragma once
/// \file
/// Collects samples as a fusion takes them, for fits of their motion.

#include "motion/window.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <optional>
#include <utility>

namespace sonopose::installation {

/// Applies calibration and delay. Leaves out what is not finite, since the fusion does not use it either,
/// and fixes of a second tag, which moves otherwise. Headings of the body, as of a compass, become those of a
/// pair with the configured mount. Beside those of a pair they are left out.
class SampleWindow {
public:
  explicit SampleWindow(const settings::Settings& settings);

  void add(const ImuSample& imu);
  void add(const UltrasonicFix& fix);
  void add(const PairHeading& heading);

  /// True if the headings are not those of a pair.
  [[nodiscard]] bool are_headings_of_body() const { return are_headings_of_body_; }

  [[nodiscard]] motion::Window window() && { return std::move(window_); }

private:
  settings::DelaySettings delay_;
  calibration::Calibration calibration_;
  std::optional<Vector3d> tag_body_m_;
  bool are_headings_of_body_ = false;
  motion::Window window_;
};

}  // namespace sonopose::installation
