// sonopose-simulate: writes a simulated run as a sensor-log folder with truth.

#include "recording/log_writer.hpp"
#include "recording/part_folder.hpp"
#include "sim/simulator.hpp"
#include "support/progress.hpp"
#include "support/run.hpp"
#include "support/wheel_options.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  std::string scenario;
  std::filesystem::path folder;
  std::uint64_t seed = 1;
  std::optional<double> duration_s;
  std::optional<double> mount_offset_deg;
  std::optional<double> delay_error_ms;
  std::vector<double> lever_arm_body_m;  ///< x, y, z; empty: lever arm of the scenario
  apps::WheelOptions wheels;
  bool list = false;
};

void add_options(apps::CommandLine& app, Options& options) {
  app.add_option("SCENARIO", options.scenario, "Scenario to simulate; --list shows all").type_name("");
  app.add_option("--out", options.folder, "New sensor-log folder; an existing recording is never overwritten")
      .type_name("DIR");
  app.add_option("--seed", options.seed, "Seed of the noise; the same seed gives the same bytes")
      .check(apps::number_between(0, 1e9))
      .capture_default_str();
  app.add_option("--duration", options.duration_s, "Length in seconds (default: the scenario's)")
      .check(apps::number_between(0.01, 1e5));
  const apps::Check metres = apps::number_between(-10.0, 10.0);
  app.add_option("--mount-offset-deg", options.mount_offset_deg,
                 "Angle from body X to the axis of the pair, to the left (default: the scenario's)")
      .check(apps::number_between(-180.0, 180.0));
  app.add_option("--delay-error-ms", options.delay_error_ms,
                 "By how much fixes and headings are older than their stamps (default: the scenario's)")
      .check(apps::number_between(-1000.0, 1000.0));
  app.add_option("--lever-arm-m", options.lever_arm_body_m,
                 "Place of the IMU, seen from the tracked point, in body axes (default: the scenario's)")
      .expected(3)
      .allow_extra_args(false)
      .type_name("X Y Z")
      .check(metres);
  apps::add_wheel_options(app, options.wheels);
  app.add_flag("--list", options.list, "List the scenarios and exit");
}

int list() {
  for (const auto& group : {sim::scenarios(), sim::harder_scenarios(), sim::violations()}) {
    for (const sim::Scenario& scenario : group) {
      apps::print("{:<20} {:>3} s  {}\n", scenario.name, scenario.duration_s, scenario.summary);
    }
  }
  return 0;
}

/// Returns the sensors of this run, installed according to the options.
sim::SensorSettings sensors_of(const Options& options, const sim::Scenario& scenario, const sim::Run& run) {
  constexpr double ms_per_s = 1e3;
  sim::SensorSettings sensors = sim::drawn(scenario, run).sensors;
  if (options.mount_offset_deg) {
    sensors.pair_mount_offset_rad = *options.mount_offset_deg * geometry::radians_per_degree;
  }
  if (options.delay_error_ms) sensors.reported_delay_error_s = -*options.delay_error_ms / ms_per_s;
  std::copy(options.lever_arm_body_m.begin(), options.lever_arm_body_m.end(),
            sensors.imu_from_tracked_point_body_m.begin());
  return sensors;
}

/// Describes the origin of the log.
recording::LogSettings settings_of(const Options& options, const sim::Scenario& scenario, double duration_s) {
  recording::LogSettings settings{{"scenario", std::string(scenario.name)},
                                  {"seed", std::to_string(options.seed)},
                                  {"duration_s", fmt::format("{}", duration_s)}};
  if (options.mount_offset_deg) {
    settings.emplace_back("mount_offset_deg", fmt::format("{}", *options.mount_offset_deg));
  }
  if (options.delay_error_ms) {
    settings.emplace_back("delay_error_ms", fmt::format("{}", *options.delay_error_ms));
  }
  if (!options.lever_arm_body_m.empty()) {
    settings.emplace_back("lever_arm_m", fmt::format("{}", fmt::join(options.lever_arm_body_m, " ")));
  }
  apps::describe(options.wheels, settings);
  return settings;
}

int write(const Options& options) {
  if (options.scenario.empty()) apps::require_option("SCENARIO");
  sim::Scenario scenario = sim::find_scenario(options.scenario);
  if (options.folder.empty()) apps::require_option("--out");
  const double duration_s = options.duration_s.value_or(scenario.duration_s);
  const sim::Run run{.seed = options.seed, .duration_s = duration_s};
  sim::SensorSettings sensors = sensors_of(options, scenario, run);
  apps::add_wheels(options.wheels, duration_s, sensors, scenario.disturbances);
  sim::Simulator simulator(scenario, sensors, run);
  const recording::PartFolder folder(options.folder);
  std::optional<recording::SensorLogWriter> log;
  log.emplace(folder.part(), settings_of(options, scenario, duration_s));
  apps::Progress progress;
  std::array<std::size_t, std::variant_size_v<Event>> count{};
  std::size_t truth_count = 0;
  TimeNs first_truth_ns = 0;
  while (const auto step = simulator.next()) {
    log->write(step->event);
    ++count.at(step->event.index());
    if (step->truth) {
      log->write(*step->truth);
      if (truth_count++ == 0) first_truth_ns = step->truth->time_ns;
      progress.at(seconds_between(first_truth_ns, step->truth->time_ns) / duration_s, "simulate");
    }
  }
  log->flush();
  log.reset();
  folder.commit();
  progress.clear();
  apps::print("{}: {}, seed {}, {} s: {}, {}, {}, {}{}\n", options.folder.string(), scenario.name,
              options.seed, duration_s, text::count_text(count[0], "IMU sample"),
              text::count_text(count[1], "fix", "fixes"), text::count_text(count[2], "heading"),
              count[3] == 0 ? "" : text::count_text(count[3], "velocity", "velocities") + ", ",
              text::count_text(truth_count, "true state"));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("simulate");
  add_options(app, options);
  return apps::run(app, argc, argv, [&options] { return options.list ? list() : write(options); });
}
