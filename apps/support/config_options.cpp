#include "config_options.hpp"

#include "help.hpp"
#include "logging/log.hpp"
#include "run.hpp"
#include <sonopose/text/nearest.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace sonopose::apps {
namespace {

constexpr const char* settings_option = "--help-settings";

void print_settings(const std::string& group) {
  constexpr std::size_t column_of_ranges = 54;
  const std::string text = config::settings_help(group);
  if (!text.empty()) throw Printed(wrapped_lines(text, column_of_ranges));
  refuse_option(settings_option, fmt::format("{}: no settings have this name{}", group,
                                             text::suggestion(group, config::settings_groups())));
}

bool has_own(const config::FusionConfig& config, BeaconAddress beacon) {
  const std::vector<BeaconAddress> own = config.beacons();
  return std::ranges::find(own, beacon) != own.end();
}

}  // namespace

void add_config_options(CommandLine& app, ConfigOptions& options) {
  app.add_option("--config", options.file, "TOML file with settings").type_name("FILE").group(settings_group);
  app.add_option("--set", options.assignments,
                 "One setting: GROUP.KEY=VALUE, or beacon.7.GROUP.KEY=VALUE for one beacon; may be repeated")
      .type_name("KEY=VALUE")
      .group(settings_group)
      .allow_extra_args(false);
  app.add_option_function<std::string>(settings_option, print_settings,
                                       "Print the settings for --set, all or those of a group, and exit")
      .type_name("[GROUP]")
      .group(settings_group)
      .expected(0, 1)
      .trigger_on_parse();
}

void add_beacon_option(CommandLine& app, BeaconAddress& beacon) {
  app.add_option("--beacon", beacon,
                 "Beacon whose own settings apply, and which is read from a file of several")
      .check(number_between(0, 65534))
      .capture_default_str();
}

void add_beacon_option(CommandLine& app, std::optional<BeaconAddress>& beacon) {
  app.add_option(
         "--beacon", beacon,
         "Beacon whose own settings apply, and which is read from an MCAP file of several (default: the one "
         "in meta.toml of the log, else 7)")
      .check(number_between(0, 65534));
}

void add_beacon_or_all_option(CommandLine& app, BeaconAddress& beacon) {
  app.add_option("--beacon", beacon, "Address of one beacon (default: all)")
      .transform({[](std::string& text) {
                    const bool is_all = text == "all";
                    if (is_all) text = std::to_string(all_beacons);
                    return is_all || number_between(0, all_beacons - 1).mistake_in(text).empty()
                               ? std::string()
                               : fmt::format("{}: must be all or 0 … {}", text, all_beacons - 1);
                  },
                  ""})
      .option_text("ADDRESS|all");
}

config::FusionConfig configuration(const ConfigOptions& options) {
  auto config = options.file ? config::FusionConfig::load(*options.file) : config::FusionConfig();
  for (const std::string& assignment : options.assignments) config.assign(assignment);
  auto other_engine = config::OtherEngine::warned_of;
  for (const auto& [key, value, beacon] : options.chosen) {
    config.assign(fmt::format("{}={}", key, value));
    if (beacon && has_own(config, *beacon))
      config.assign(fmt::format("beacon.{}.{}={}", *beacon, key, value));
    if (key == "fusion.engine") other_engine = config::OtherEngine::ignored;
  }
  config.check();
  for (const std::string& warning : config.warnings(other_engine)) logging::warning(warning);
  return config;
}

settings::Settings settings_of(const config::FusionConfig& config, BeaconAddress beacon) {
  const std::vector<BeaconAddress> others = config.beacons();
  if (!others.empty() && !has_own(config, beacon)) {
    logging::warning(fmt::format("not used: the settings of beacon {}; {}", fmt::join(others, ", "),
                                 beacon == all_beacons ? "the beacon is not known; --beacon selects one"
                                                       : fmt::format("this is beacon {}", beacon)));
  }
  return config.for_beacon(beacon);
}

}  // namespace sonopose::apps
