#include "wheel_options.hpp"

#include <fmt/format.h>

namespace sonopose::apps {

void add_wheel_options(CommandLine& app, WheelOptions& options) {
  auto rate = app.add_option("--twist", options.rate_hz,
                             "Rate in Hz of the speed of wheels, along body X (default: the scenario's)")
                  .check(number_between(1.0, 1000.0))
                  .type_name("HZ");
  app.add_option("--twist-scale-error", options.scale_error_percent,
                 "By how many percent that speed is too high")
      .check(number_between(-50.0, 50.0))
      .needs(rate);
  app.add_option("--twist-slip", options.slip_percent,
                 "By how many percent the wheels slip for a second, every ten seconds")
      .check(number_between(-100.0, 1000.0))
      .needs(rate);
}

void add_wheels(const WheelOptions& options, double duration_s, sim::SensorSettings& sensors,
                sim::Disturbances& disturbances) {
  constexpr double share_per_percent = 0.01;
  constexpr int every_s = 10;
  if (!options.rate_hz) return;
  sensors.wheel_rate_hz = *options.rate_hz;
  sensors.wheel_scale_error = share_per_percent * options.scale_error_percent;
  if (options.slip_percent == 0) return;
  for (int begin_s = every_s; begin_s < duration_s; begin_s += every_s) {
    disturbances.wheel_slips.push_back(
        {static_cast<double>(begin_s), 1.0, share_per_percent * options.slip_percent});
  }
}

void describe(const WheelOptions& options, recording::LogSettings& settings) {
  if (!options.rate_hz) return;
  settings.emplace_back("twist_hz", fmt::format("{}", *options.rate_hz));
  settings.emplace_back("twist_scale_error_percent", fmt::format("{}", options.scale_error_percent));
  settings.emplace_back("twist_slip_percent", fmt::format("{}", options.slip_percent));
}

}  // namespace sonopose::apps
