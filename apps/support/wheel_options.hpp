#pragma once
/// \file
/// Command-line options of simulated wheels.

#include "recording/log_meta.hpp"
#include "run.hpp"
#include "sim/scenario.hpp"

#include <optional>

namespace sonopose::apps {

/// Wheels that a simulated vehicle has in addition to the scenario's sensors.
struct WheelOptions {
  std::optional<double> rate_hz;  ///< empty: wheels of the scenario
  double scale_error_percent = 0;
  double slip_percent = 0;
};

void add_wheel_options(CommandLine& app, WheelOptions& options);

/// Adds the wheels, and slips of a second every ten seconds.
void add_wheels(const WheelOptions& options, double duration_s, sim::SensorSettings& sensors,
                sim::Disturbances& disturbances);

/// Describes them in the log.
void describe(const WheelOptions& options, recording::LogSettings& settings);

}  // namespace sonopose::apps
