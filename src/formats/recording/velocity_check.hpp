#pragma once
/// \file
/// Checks of recorded velocities against fixes and gyroscope.

#include "motion/window.hpp"
#include <sonopose/samples/samples.hpp>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recording {

/// Collects the velocities of one beacon, in their order.
class VelocityCheck {
public:
  void add(const TwistSample& twist);

  /// Suspects another unit if measured speeds are a multiple of those that the fixes show over a second or
  /// more. `how_to_name`: sentence about where to name a unit.
  [[nodiscard]] std::optional<std::string> unit(
      std::vector<motion::Position> fixes, const std::function<std::string(const char*)>& how_to_name) const;

  /// Suspects swapped wheels, or another sense of rotation, if measured turns are against the gyroscope's.
  [[nodiscard]] std::optional<std::string> sign_of_turns(const std::vector<motion::Reading>& imu) const;

private:
  std::vector<std::pair<TimeNs, double>> speeds_mps_;  ///< along the measured axes, with their stamps
  std::vector<motion::Reading> rates_;                 ///< measured turns
  bool are_horizontal_ = true;                         ///< false if axis z alone was measured
};

}  // namespace sonopose::recording
