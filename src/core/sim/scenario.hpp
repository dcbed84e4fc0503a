#pragma once
/// \file
/// Scenarios: each a motion, sensors and disturbances.

#include "sim/disturbances.hpp"
#include "sim/sensors.hpp"
#include "sim/trajectory.hpp"

#include <functional>
#include <span>
#include <string_view>

namespace sonopose::sim {

/// A named test case.
struct Scenario {
  std::string_view name;
  std::string_view summary;  ///< one sentence for the programs' help
  std::function<Path(double time_s)> path;
  SensorSettings sensors{};
  Disturbances disturbances{};
  bool random_start_yaw = false;  ///< true if each seed turns the whole path by a random angle
  double duration_s = 60;         ///< default length; every path continues beyond it
  double score_after_s = 6;       ///< time before which poses are not scored
  /// Draws the path, sensors and disturbances of one run; null: equal in all runs.
  void (*vary)(Scenario& scenario, Random& random) = nullptr;

  /// Exact state on the path `time_s` after the start, before any turn and relocation.
  [[nodiscard]] Motion motion(double time_s) const { return motion_on(path(time_s)); }
};

/// Scenarios with one difficulty each and the same motion in every run.
std::span<const Scenario> scenarios();

/// Scenarios whose difficulties differ from run to run.
std::span<const Scenario> harder_scenarios();

/// Scenarios whose sensors violate what an estimator assumes of them.
std::span<const Scenario> violations();

/// Finds a scenario of any kind. Throws std::invalid_argument, listing the known names.
const Scenario& find_scenario(std::string_view name);

}  // namespace sonopose::sim
