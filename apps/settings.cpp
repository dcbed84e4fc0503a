// sonopose-settings: asks a running fusion which settings hold, and tells it to use others.

#include "support/app.hpp"
#include "settings_client/settings_client.hpp"
#include "settings_client/settings_report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

using namespace sonopose;

namespace {

struct Options {
  apps::BusOptions bus;
  std::vector<std::string> words;  ///< keys, or assignments
  BeaconAddress address = all_beacons;
  std::uint64_t from_event = 0;
  double timeout_s = 5.0;
  double duration_s = 0.0;
  bool json = false;
  settings_client::SettingsClient client() const { return {bus.domain, bus.qos_file}; }
};

[[noreturn]] void fail(const Options& options, const char* nothing) {
  throw std::runtime_error(
      fmt::format("{} within {} s: is sonopose-fusion running in this domain?", nothing, options.timeout_s));
}

int get(const Options& options) {
  settings_client::check_names(options.words);
  auto found = options.client().in_force(options.address, options.timeout_s);
  if (found.empty()) fail(options, "no settings came");
  if (options.address != all_beacons && found.front().address == all_beacons) {
    throw std::runtime_error(
        fmt::format("beacon {} has not been heard; without --beacon, get prints what holds "
                    "for any beacon that has no values of its own",
                    options.address));
  }
  if (options.json) {
    for (auto& settings : found) settings = settings_client::chosen(std::move(settings), options.words);
    fmt::print("{}", settings_client::json_of(found));
  } else {
    fmt::print("{}", settings_client::toml_of(found, options.words));
  }
  return 0;
}

int set(const Options& options) {
  SettingsRequest request{.address = options.address, .from_sequence = options.from_event, .assignments = {}};
  for (const auto& word : options.words) request.assignments.push_back(settings_client::read_assignment(word));
  const auto reply = options.client().change(request, options.timeout_s);
  if (!reply) fail(options, "no fusion answered");
  if (!reply->accepted) throw std::runtime_error("refused: " + reply->reason);
  if (!reply->reason.empty()) fmt::print(stderr, "sonopose-settings: warning: {}\n", reply->reason);
  fmt::print("accepted: {}\n", settings_client::when_of(*reply));
  return 0;
}

int watch(const Options& options) {
  process::StopSignal stop;
  stop.listen_to_signals();
  settings_client::SettingsObserver changes(options.json);
  const auto print = [&changes](const EffectiveSettings& settings) {
    if (!changes.knows(settings.address)) {
      const bool all = settings.address == all_beacons;
      fmt::print(stderr, "watching {}\n",
                 all ? "what is for all" : fmt::format("beacon {}", settings.address));
    }
    fmt::print("{}", changes.on(settings));
    std::fflush(stdout);
  };
  options.client().watch(options.address, print, options.duration_s, stop);
  return 0;
}

int reset(const Options& options) {
  const auto done = options.client().reset(options.address, options.timeout_s);
  if (done.empty()) fail(options, "no beacon was reset");
  for (const BeaconAddress address : done) fmt::print("beacon {} was reset\n", address);
  return 0;
}

std::string address_text(const std::string& text) {
  if (text == "all") return std::to_string(all_beacons);
  if (CLI::Range(0, all_beacons - 1)(text).empty()) return text;
  throw CLI::ValidationError(fmt::format("{}: not all or 0 … {}", text, all_beacons - 1));
}

CLI::App* add_command(CLI::App& app, Options& options, const char* name, const char* description) {
  auto* command = app.add_subcommand(name, description);
  command->fallthrough();  // the program's options may stand behind it
  command->add_option("--beacon", options.address, "One beacon's address; without it, all")
      ->transform(address_text)
      ->option_text("ADDRESS|all");
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Shows and changes the settings of a running sonopose-fusion.", "sonopose-settings");
  add_bus_options(app, options.bus);
  app.add_option("--timeout", options.timeout_s, "Seconds to wait for a fusion (get, set, reset)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.require_subcommand(1);

  auto* getting = add_command(app, options, "get", "Print the settings that hold");
  getting->add_option("KEY", options.words, "Keys (drift.jump_alpha) or groups (drift); without any, all");
  getting->add_flag("--json", options.json, "A JSON array with an object per beacon, instead of TOML");

  auto* setting = add_command(app, options, "set", "Change settings: all that are named, or none");
  setting->add_option("KEY=VALUE", options.words, "What shall hold")->required();
  setting->add_option("--from-event", options.from_event, "Number of the first event; else the next one");

  auto* watching = add_command(app, options, "watch", "Print each change when it takes hold");
  watching->add_flag("--json", options.json, "One JSON object per change");
  watching->add_option("--duration", options.duration_s, "End after this many seconds; 0: without end")
      ->check(CLI::NonNegativeNumber);

  add_command(app, options, "reset", "Let engines begin anew, and wait until they have");

  return apps::run(app, argc, argv, [&] {
    if (getting->parsed()) return get(options);
    if (setting->parsed()) return set(options);
    return watching->parsed() ? watch(options) : reset(options);
  });
}
