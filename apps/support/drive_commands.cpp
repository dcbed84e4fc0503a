#include "drive_commands.hpp"

#include "bag_options.hpp"
#include "evaluation/calibration/calibration.hpp"
#include "files/replacement.hpp"
#include "logging/log.hpp"
#include "output.hpp"
#include "plots/likelihood_plot.hpp"
#include "progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string_view>
#include <utility>

namespace sonopose::apps {
namespace {

using calibration::drive::Quantity;

const std::vector<Quantity> lever_arm{Quantity::lever_arm_x, Quantity::lever_arm_y, Quantity::lever_arm_z};
const std::vector<Quantity> noise{Quantity::fix_horizontal, Quantity::fix_vertical, Quantity::heading,
                                  Quantity::accel, Quantity::gyro};

std::vector<Quantity> all() {
  std::vector<Quantity> quantities{Quantity::mount, Quantity::delay};
  quantities.insert(quantities.end(), lever_arm.begin(), lever_arm.end());
  quantities.insert(quantities.end(), noise.begin(), noise.end());
  return quantities;
}

/// Writes the settings to the file. Warns about those that the file overrides for a single beacon.
void write_settings(const std::filesystem::path& file, const std::vector<toml::Assignment>& settings) {
  if (settings.empty()) {
    logging::warning(fmt::format("{}: not changed: neither mount nor delay is known", file.string()));
    return;
  }
  toml::merge(file, settings);
  for (const toml::Leaf& leaf : evaluation::overriding(file, settings)) {
    logging::warning(
        fmt::format("{}:{}: {} = {} still applies to its beacon instead of the calibrated value: remove "
                    "the line, or calibrate that beacon with --beacon",
                    file.string(), leaf.line, leaf.key, toml::text_of(leaf.value)));
  }
}

}  // namespace

DriveCommands::DriveCommands(CommandLine& app) {
  add(app, "mount", "From a drive: the angle from body X to the axis of the paired beacons",
      {Quantity::mount});
  add(app, "delay", "From a drive: by how much the delay that fixes carry is wrong", {Quantity::delay});
  add(app, "lever-arm", "From a drive: where the IMU is, seen from the tracked point", lever_arm);
  add(app, "noise", "From a drive: the noise of fixes, headings, accelerometer and gyroscope", noise);
  add(app, "all",
      "From a drive: all of these. Drive for two minutes, with curves both ways and changes of speed", all());
}

void DriveCommands::add(CommandLine& app, const char* name, const char* what, std::vector<Quantity> wanted) {
  CommandLine command = app.add_subcommand(name, what);
  command
      .add_option("LOG", logs_,
                  "Sensor-log folders or MCAP files of one installation; no ground truth is needed")
      .required()
      .type_name("DIR");
  add_bag_options(command);
  command
      .add_option("--out", out_,
                  "Write the settings to this file, replace it if it exists, and print only the report")
      .type_name("FILE");
  command.add_option("--plot", plot_, "Draw the likelihood to a .svg or .png file (needs gnuplot)")
      .type_name("FILE");
  command
      .add_option("--beacon", beacon_,
                  "Use and write the settings of this beacon only; the one to read from a file of several")
      .check(number_between(0, all_beacons - 1));
  command.add_flag("--json", json_, "Print one JSON object instead of text");
  add_config_options(command, config_);
  const bool has_settings = wanted.front() == Quantity::mount || wanted.front() == Quantity::delay;
  if (has_settings) {
    command
        .add_option("--write", write_,
                    "Change these settings in an existing TOML file, or create it. All other lines and "
                    "comments stay; its "
                    "settings apply unless --config names another file")
        .type_name("FILE");
  }
  commands_.push_back({command, std::move(wanted)});
}

bool DriveCommands::is_given() const {
  return std::any_of(commands_.begin(), commands_.end(),
                     [](const Command& command) { return command.app.parsed(); });
}

evaluation::DriveCalibration DriveCommands::calibrated(const Command& command) const {
  Progress progress;
  evaluation::DriveRequest request;
  request.logs = logs_;
  request.beacon = beacon_;
  request.wanted = command.wanted;
  ConfigOptions config = config_;
  // Other settings of that file, such as axes, determine the meaning of the result.
  if (write_ && !config.file && std::filesystem::exists(*write_)) config.file = write_;
  request.settings = settings_of(configuration(config), beacon_.value_or(all_beacons));
  request.options.curves = plot_.has_value();
  request.options.on_progress = [&progress](std::string_view stage, int step) {
    progress.at(std::numeric_limits<double>::quiet_NaN(), fmt::format("{}, step {}", stage, step + 1));
  };
  return evaluation::calibrate_drive(request);
}

int DriveCommands::run() const {
  const auto command =
      std::find_if(commands_.begin(), commands_.end(), [](const Command& each) { return each.app.parsed(); });
  std::optional<plots::LikelihoodPlot> plot;
  if (plot_) plot.emplace(*plot_);
  const evaluation::DriveCalibration result = calibrated(*command);
  const std::string toml = evaluation::drive_toml(result, beacon_);
  if (out_) files::write_whole(*out_, toml);
  if (write_) write_settings(*write_, evaluation::drive_settings(result, beacon_));
  if (json_) {
    apps::print("{}", evaluation::drive_json(result));
  } else {
    apps::print("{}", out_ || write_ ? evaluation::drive_text(result) : toml);
  }
  if (plot) plot->draw(result);
  return 0;
}

}  // namespace sonopose::apps
