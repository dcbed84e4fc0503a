#pragma once
// The option --north, common to the programs that send to autopilots.

#include "run.hpp"

#include <numbers>
#include <optional>

namespace sonopose::apps {

/// Adds --north in degrees, which sets the direction in radians.
inline Option add_north_option(CommandLine& app, std::optional<double>& north_rad) {
  return app
      .add_option_function<double>(
          "--north", [&north_rad](double north_deg) { north_rad = north_deg * std::numbers::pi / 180.0; },
          "Direction of north in the map for an autopilot, counter-clockwise from x: 90 if y is north "
          "(default: unknown; its heading is then that of the map)")
      .check(number_between(-360.0, 360.0))
      .type_name("DEG");
}

}  // namespace sonopose::apps
