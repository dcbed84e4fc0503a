// sonopose-attitude: runs an attitude filter over logs and scores it against the truth.

#include "bus_log/sensor_log.hpp"
#include "evaluation/replay/attitude_run.hpp"
#include "evaluation/report/trajectory_file.hpp"
#include "logging/log.hpp"
#include "support/bag_options.hpp"
#include "support/config_options.hpp"
#include "support/progress.hpp"
#include "support/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>

namespace {

using namespace sonopose;
using Path = std::filesystem::path;

struct Options {
  std::vector<Path> logs;
  apps::ConfigOptions config;
  BeaconAddress beacon = recording::default_log_address;
  std::optional<BeaconAddress> address;  ///< --beacon, if it is given
  std::optional<std::string> filter;
  std::optional<std::string> magnetometer;
  std::optional<Path> out;
  bool json = false;
};

void add_options(apps::CommandLine& app, Options& options) {
  std::vector<std::string> filters;
  for (const std::string_view name : choices_of(attitude::FilterKind{})) filters.emplace_back(name);
  app.add_option("LOG", options.logs,
                 "Log folders, MCAP files or folders of them; the score uses the truth and movement.csv")
      .required()
      .type_name("PATH");
  app.add_option("--filter", options.filter, "Attitude filter; overrides the settings")
      .check(apps::one_of(filters));
  app.add_option("--magnetometer", options.magnetometer,
                 "Use the magnetometer for the heading; overrides the settings")
      .check(apps::one_of({"on", "off"}));
  apps::add_bag_options(app);
  apps::add_config_options(app, options.config);
  apps::add_beacon_option(app, options.beacon);
  app.add_option("--out", options.out, "Write LOG.tum for each log to this folder, with position 0")
      .type_name("DIR");
  app.add_flag("--json", options.json, "Print one JSON object instead of the table");
}

/// Returns the last component of a log's path, without a trailing slash.
std::string name_of(const Path& log) {
  const Path whole = std::filesystem::weakly_canonical(log);
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

/// Refuses two logs with the same name, which would write the same file.
void check_names(const std::vector<Path>& logs) {
  std::set<std::string> names;
  for (const Path& log : logs) {
    if (!names.insert(name_of(log)).second) {
      throw std::runtime_error(
          fmt::format("--out: two logs have the name {}; write them to different folders", name_of(log)));
    }
  }
}

evaluation::AttitudeResult run_log(const Path& folder, const Options& options,
                                   const settings::Settings& settings, apps::Progress& progress) {
  const recording::AttitudeLog log = bus_log::read_attitude_log(folder, options.address);
  const bool has_field = std::any_of(log.imu.begin(), log.imu.end(), [](const ImuSample& imu) {
    return imu.magnetic_field_body_t.has_value();
  });
  if (settings.attitude.selection.magnetometer && !has_field) {
    throw files::IoError(bus_log::imu_source(folder).string() +
                         ": no magnetometer data, but the magnetometer is on");
  }
  std::optional<evaluation::TrajectoryFile> trajectory;
  if (options.out) trajectory.emplace(*options.out / (name_of(folder) + ".tum"));
  const std::string name = name_of(folder);
  std::size_t samples = 0;
  auto result = evaluation::run_attitude(name, log, settings, [&](TimeNs time_ns, const Quaterniond& q) {
    progress.at(static_cast<double>(++samples) / static_cast<double>(log.imu.size()), name);
    if (trajectory) trajectory->write(time_ns, Vector3d::Zero(), q);
  });
  if (trajectory) trajectory->flush();
  if (trajectory) trajectory->commit();
  return result;
}

/// Returns the settings, overridden by --filter and --magnetometer.
settings::Settings settings_of(const Options& options) {
  apps::ConfigOptions config = options.config;
  const auto set = [&](const std::string& key, const std::string& value) {
    config.chosen.push_back({key, value, options.beacon});
  };
  set("fusion.engine", "documented");  // the engine with these attitude filters
  if (options.filter) set("documented.attitude.filter", *options.filter);
  if (options.magnetometer)
    set("documented.attitude.magnetometer", *options.magnetometer == "on" ? "true" : "false");
  return apps::settings_of(apps::configuration(config), options.beacon);
}

int run_logs(const Options& options) {
  const settings::Settings settings = settings_of(options);
  if (options.out) {
    check_names(options.logs);
    evaluation::make_folder(*options.out);
  }
  std::vector<evaluation::AttitudeResult> results;
  apps::Progress progress;
  const auto print_results = [&] {
    progress.clear();
    apps::print("{}", options.json ? evaluation::attitude_json(results) : evaluation::attitude_text(results));
  };
  try {
    for (const Path& log : options.logs) results.push_back(run_log(log, options, settings, progress));
  } catch (...) {
    if (!results.empty()) print_results();  // results of the earlier logs
    throw;
  }
  print_results();
  bool are_used = true;
  for (const evaluation::AttitudeResult& result : results) {
    const bool is_useless = result.scored == 0 && !options.out;
    if (is_useless) {
      logging::warning(fmt::format(
          "{}: not scored: no sample has a true attitude; --out writes that of the filter", result.name));
    }
    are_used = are_used && !is_useless && 2 * result.rejected <= result.samples;
  }
  return are_used ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("attitude");
  add_options(app, options);
  return sonopose::apps::run(app, argc, argv, [&] {
    if (app.count("--beacon") > 0) options.address = options.beacon;
    return run_logs(options);
  });
}
