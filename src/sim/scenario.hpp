#pragma once
/// \file
/// The scenarios: each a motion, sensors and disturbances.

#include "sim/disturbances.hpp"
#include "sim/sensors.hpp"
#include "sim/trajectory.hpp"

#include <span>
#include <string_view>

namespace sonopose::sim {

/// A named test case.
struct Scenario {
  std::string_view name;
  std::string_view summary;  ///< one sentence for the programs' help
  Path (*path)(double time_s) = nullptr;
  SensorSettings sensors{};
  Disturbances disturbances{};
  bool random_start_yaw = false;  ///< each seed turns the whole path by a random angle
  double duration_s = 60;         ///< default length; every path continues beyond it
  double score_after_s = 6;       ///< poses before this are not scored

  /// The exact state on the path `time_s` after the start, before any turn and relocation.
  [[nodiscard]] Motion motion(double time_s) const { return motion_on(path(time_s)); }
};

/// All scenarios.
std::span<const Scenario> scenarios();

/// The scenario of that name. Throws std::invalid_argument, which lists the known names.
const Scenario& find_scenario(std::string_view name);

}  // namespace sonopose::sim
