#include "config_options.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

namespace sonopose::apps {

void add_config_options(CLI::App& app, ConfigOptions& options) {
  app.add_option("--config", options.file, "TOML file with settings")->type_name("FILE");
  app.add_option("--set", options.assignments,
                 "One setting: GROUP.KEY=VALUE, or beacon.7.GROUP.KEY=VALUE for one beacon; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.footer(config::settings_help);
}

void add_beacon_option(CLI::App& app, BeaconAddress& beacon) {
  app.add_option("--beacon", beacon, "Beacon whose own settings apply")
      ->check(CLI::Range(0, 65534))
      ->capture_default_str();
}

void add_beacon_option(CLI::App& app, std::optional<BeaconAddress>& beacon) {
  app.add_option("--beacon", beacon,
                 "Beacon whose own settings apply (default: the one in meta.toml of the log, else 7)")
      ->check(CLI::Range(0, 65534));
}

void assign_everywhere(ConfigOptions& options, BeaconAddress beacon, const std::string& key,
                       const std::string& value) {
  options.assignments.push_back(fmt::format("{}={}", key, value));
  options.assignments.push_back(fmt::format("beacon.{}.{}={}", beacon, key, value));
}

config::FusionConfig configuration(const CLI::App& /*app*/, const ConfigOptions& options) {
  auto config = options.file ? config::FusionConfig::load(*options.file) : config::FusionConfig();
  for (const std::string& assignment : options.assignments) config.assign(assignment);
  config.check();
  for (const std::string& warning : config.warnings()) logging::warning(warning);
  return config;
}

}  // namespace sonopose::apps
