#pragma once
/// \file
/// The list of scenarios: each a motion, the sensors that take part in it, and what goes wrong.

#include "sim/disturbances.hpp"
#include "sim/sensors.hpp"
#include "sim/trajectory.hpp"

#include <span>
#include <string_view>

namespace sonopose::sim {

/// A whole case with a name.
struct Scenario {
  std::string_view name;
  std::string_view summary;  ///< one sentence for the programs' help
  Path (*path)(double time_s) = nullptr;
  SensorSettings sensors{};
  Disturbances disturbances{};
  bool random_start_yaw = false;  ///< each seed turns the whole path by an angle of its own
  double duration_s = 60;         ///< how long it takes to show everything; every path goes on after it
  double score_after_s = 6;       ///< from when on a pose is compared with the truth

  /// The exact state on the path `time_s` after the start, before any turn and relocation.
  [[nodiscard]] Motion motion(double time_s) const { return motion_on(path(time_s)); }
};

/// All scenarios.
std::span<const Scenario> scenarios();

/// The scenario of that name. Throws std::invalid_argument, which lists the known names.
const Scenario& find_scenario(std::string_view name);

}  // namespace sonopose::sim
