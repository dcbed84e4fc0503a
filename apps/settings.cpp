// sonopose-settings: reads and changes the settings of a running fusion.

#include "logging/log.hpp"
#include "settings_client/settings_client.hpp"
#include "settings_client/settings_report.hpp"
#include "support/bus_options.hpp"
#include "support/config_options.hpp"
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

using namespace sonopose;
using namespace sonopose::settings_client;

namespace {

struct Options {
  apps::BusOptions bus;
  std::vector<std::string> words;  ///< keys, or assignments
  std::filesystem::path file;
  std::filesystem::path base = SONOPOSE_CONFIG_FOLDER "/fusion.toml";
  BeaconAddress address = all_beacons;
  std::uint64_t from_event = 0;
  double timeout_s = 5.0;
  double duration_s = 0.0;
  bool json = false;
  SettingsClient client() const { return {bus.domain, bus.qos_file}; }
};

[[noreturn]] void fail(const Options& options, const char* what) {
  throw std::runtime_error(
      fmt::format("{} within {} s: is sonopose-fusion running in this domain?", what, options.timeout_s));
}

int get(const Options& options) {
  check_names(options.words);
  auto found = options.client().effective(options.address, options.timeout_s);
  if (found.empty()) fail(options, "no settings arrived");
  if (options.address != all_beacons && found.front().address == all_beacons) {
    throw std::runtime_error(fmt::format(
        "the fusion has received nothing from beacon {}; without --beacon, get prints the settings for all",
        options.address));
  }
  if (options.json) {
    for (auto& settings : found) settings = selected(std::move(settings), options.words);
    apps::print("{}", json_of(found));
  } else {
    apps::print("{}", toml_of(found, options.words));
  }
  return 0;
}

int set(const Options& options) {
  SettingsRequest request{.address = options.address, .from_sequence = options.from_event, .assignments = {}};
  for (const auto& word : options.words) request.assignments.push_back(parse_assignment(word));
  const auto reply = options.client().change(request, options.timeout_s);
  if (!reply) fail(options, "no fusion answered");
  if (!reply->accepted) throw std::runtime_error("refused: " + text::escaped(reply->reason));
  if (!reply->reason.empty()) logging::warning(text::escaped(reply->reason));
  apps::print("accepted: {}\n", effective_time_text(*reply));
  return changes_no_known_beacon(*reply) ? 1 : 0;
}

int save(const Options& options) {
  const auto changed = options.client().changed(options.timeout_s);
  if (changed.empty()) fail(options, "not all settings arrived");
  logging::info(options.file.empty() ? save_drop_in(changed, options.base)
                                     : settings_client::save(changed, options.file));
  return 0;
}

int watch(const Options& options) {
  process::StopSignal stop;
  stop.listen_to_signals();
  SettingsObserver changes(options.json);
  const auto print = [&changes](const EffectiveSettings& settings) {
    if (!changes.has_settings_of(settings.address)) {
      const bool all = settings.address == all_beacons;
      logging::info(fmt::format(
          "watching {}", all ? "the settings for all beacons" : fmt::format("beacon {}", settings.address)));
    }
    apps::print("{}", changes.on(settings));
    apps::flush_output();
  };
  options.client().observe(options.address, print, options.duration_s, stop);
  return 0;
}

int reset(const Options& options) {
  const auto done = options.client().reset(options.address, options.timeout_s);
  if (done.empty() && options.address != all_beacons) {
    throw std::runtime_error(
        fmt::format("beacon {} was not reset within {} s: does a fusion of this domain receive it?",
                    options.address, options.timeout_s));
  }
  if (done.empty()) fail(options, "no beacon was reset");
  for (const BeaconAddress address : done) apps::print("beacon {} was reset\n", address);
  return 0;
}

apps::CommandLine add_command(apps::CommandLine& app, Options& options, const char* name,
                              const char* description) {
  auto command = app.add_subcommand(name, description);
  apps::add_beacon_or_all_option(command, options.address);
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("settings");
  add_bus_options(app, options.bus);
  app.add_option("--timeout", options.timeout_s, "Seconds to wait for an answer (get, set, save, reset)")
      .check(apps::number_between(0.001, 1e6))
      .capture_default_str();
  app.require_subcommand();
  app.fallthrough();  // lets the program's options follow the command
  auto getting = add_command(app, options, "get", "Print the settings in use");
  getting.add_option("KEY", options.words, "Keys (documented.drift.jump_alpha) or groups (default: all)");
  getting.add_flag("--json", options.json, "Print a JSON array with one object per beacon instead of TOML");
  auto setting = add_command(app, options, "set", "Change settings: all of the given ones, or none");
  setting.add_option("KEY=VALUE", options.words, "New values").required();
  setting.add_option("--from-event", options.from_event, "First event that uses them (default: the next)")
      .check(apps::number_between(0, 1e15));
  auto watching = add_command(app, options, "watch", "Print each change when it takes effect");
  watching.add_flag("--json", options.json, "Print one JSON object per change");
  watching.add_option("--duration", options.duration_s, "Exit after this many seconds; 0: run until stopped")
      .check(apps::number_between(0.0, 1e9));
  auto saving = app.add_subcommand("save", "Keep the settings for the next start of the fusion");
  saving.add_option("FILE", options.file, "What differs from the defaults (default: a drop-in)");
  saving.add_option("--config", options.base, "Write its drop-in 90-saved.toml: what differs from it")
      .option_text("FILE (default: " + options.base.string() + ")");
  add_command(app, options, "reset", "Restart the engines and wait until they have restarted");

  return apps::run(app, argc, argv, [&] {
    const logging::Session log(logging::Level::info);
    if (getting.parsed()) return get(options);
    if (setting.parsed()) return set(options);
    if (saving.parsed()) return save(options);
    return watching.parsed() ? watch(options) : reset(options);
  });
}
