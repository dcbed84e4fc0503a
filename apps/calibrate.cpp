// sonopose-calibrate: estimates sensor errors and the installation from recordings.

#include "evaluation/calibration/allan.hpp"
#include "evaluation/calibration/calibration.hpp"
#include "files/replacement.hpp"
#include "plots/allan_plot.hpp"
#include "support/bag_options.hpp"
#include "support/drive_commands.hpp"
#include "support/expanded_option.hpp"
#include "support/run.hpp"
#include "support/waiting.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>

namespace {

using namespace sonopose;
using Path = std::filesystem::path;

struct Options {
  Path log;
  std::optional<Path> out;
  std::optional<BeaconAddress> beacon;
  std::optional<double> field_ut;
  std::optional<Path> plot;
  bool json = false;
};

apps::CommandLine add_command(apps::CommandLine& app, const std::string& name, const std::string& what,
                              Options& options) {
  apps::CommandLine command = app.add_subcommand(name, what);
  command
      .add_option("LOG", options.log,
                  "Sensor-log folder (only imu.csv is read), MCAP file or rosbag2 recording")
      .required()
      .type_name("DIR");
  apps::add_expanded_option(command);
  apps::add_bag_options(command);
  command.add_flag("--json", options.json, "Print one JSON object instead of text");
  return command;
}

void add_output(apps::CommandLine& command, Options& options) {
  command
      .add_option("--out", options.out,
                  "Write the TOML tables to this file, replace it if it exists, and print only the report")
      .type_name("FILE");
  command
      .add_option("--beacon", options.beacon,
                  "Write the settings for this beacon only; the one to read from a file of several")
      .check(apps::number_between(0, all_beacons - 1));
}

/// Returns the result of a potentially long fit, and shows its progress.
template <class Fit>
auto shown(const Options& options, const Fit& fit) {
  const apps::Waiting waiting(options.log.filename().string());
  return fit();
}

/// Prints the report. The tables go to --out, otherwise to standard output below the report as comments.
int print_result(const Options& options, const evaluation::CalibrationResult& result) {
  const std::string toml = evaluation::calibration_toml(result, options.beacon);
  if (options.out) files::write_whole(*options.out, toml);
  if (options.json) {
    apps::print("{}", evaluation::calibration_json(result));
  } else {
    apps::print("{}", options.out ? evaluation::calibration_text(result) : toml);
  }
  return 0;
}

int analyse(const Options& options) {
  std::optional<plots::AllanPlot> plot;
  if (options.plot) plot.emplace(*options.plot);
  const evaluation::AllanResult result =
      shown(options, [&options] { return evaluation::analyse_allan(options.log, options.beacon); });
  if (plot) plot->draw(result);
  apps::print("{}", options.json ? evaluation::allan_json(result) : evaluation::allan_text(result));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app(
      "calibrate",
      "Recordings contain raw readings. For a calibration from a drive, --config and --set say how the IMU's "
      "samples are corrected and which fixes are accepted.");
  app.require_subcommand();
  apps::CommandLine imu = add_command(
      app, "imu",
      "Accelerometer and gyroscope: hold the sensor still for 2 s in each of 12 or more "
      "orientations (at least nine for all errors, six for offset and sensitivity), and turn it by "
      "more than 17 degrees in between",
      options);
  apps::CommandLine gyroscope =
      add_command(app, "gyroscope", "Offset of the gyroscope: keep the sensor at rest", options);
  apps::CommandLine magnetometer = add_command(
      app, "magnetometer", "Hard and soft iron: turn the sensor slowly through all directions", options);
  apps::CommandLine allan =
      add_command(app, "allan", "Noise as Allan deviation: keep the sensor at rest for hours", options);
  for (apps::CommandLine command : {imu, gyroscope, magnetometer}) add_output(command, options);
  magnetometer
      .add_option("--field-ut", options.field_ut,
                  "Strength of the local magnetic field in microtesla (default: from the readings)")
      .check(apps::number_between(1.0, 1000.0));
  allan.add_option("--plot", options.plot, "Draw the curves to a .svg or .png file (needs gnuplot)")
      .type_name("FILE");
  const apps::DriveCommands drive(app);
  return apps::run(app, argc, argv, [&] {
    if (drive.is_given()) return drive.run();
    if (allan.parsed()) return analyse(options);
    return print_result(options, shown(options, [&] {
                          if (imu.parsed()) return evaluation::calibrate_imu(options.log, options.beacon);
                          if (gyroscope.parsed())
                            return evaluation::calibrate_gyroscope(options.log, options.beacon);
                          return evaluation::calibrate_magnetometer(options.log, options.field_ut,
                                                                    options.beacon);
                        }));
  });
}
