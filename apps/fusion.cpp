// sonopose-fusion: subscribes to the bridge's samples and publishes the fused pose of every beacon.

#include "support/app.hpp"
#include <sonopose/nodes/fusion_node.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <vector>

namespace {

struct Options {
  sonopose::apps::BusOptions bus;
  std::string config_file;
  std::vector<std::string> assignments;
  bool lossless = false;
  bool print_config = false;
  bool print_settings_page = false;
};

sonopose::config::FusionConfig configuration(const Options& options) {
  using sonopose::config::FusionConfig;
  auto config = options.config_file.empty() ? FusionConfig{} : FusionConfig::load(options.config_file);
  for (const auto& assignment : options.assignments) config.assign(assignment);
  for (const auto& warning : config.warnings()) fmt::print(stderr, "sonopose-fusion: warning: {}\n", warning);
  return config;
}

int serve(const Options& options) {
  if (options.print_settings_page) {
    fmt::print("{}", sonopose::config::settings_page());
    return 0;
  }
  const auto config = configuration(options);
  if (options.print_config) {
    fmt::print("{}", config.to_toml());
    return 0;
  }
  sonopose::nodes::StopSignal stop;
  stop.listen_to_signals();
  sonopose::nodes::FusionNode node({options.bus.domain, options.bus.qos_file, config, options.lossless});
  fmt::print(stderr, "sonopose-fusion: serving\n");
  node.run(stop);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Fuses IMU samples and ultrasonic fixes into a pose for every beacon on the bus.",
               "sonopose-fusion");
  add_bus_options(app, options.bus);
  app.add_option("--config", options.config_file, "Settings, a TOML file")->type_name("FILE");
  app.add_option("--set", options.assignments,
                 "One setting: GROUP.KEY=VALUE, or beacon.7.GROUP.KEY=VALUE for one beacon; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_flag("--lossless", options.lossless,
               "Keep every event and pose and wait for slow consumers: for a log played at --rate 0");
  app.add_flag("--print-config", options.print_config, "Print the settings as commented TOML and end");
  app.add_flag("--print-settings-page", options.print_settings_page,
               "Print the table of all settings as a page of the docs and end");
  return sonopose::apps::run(app, argc, argv, [&options] { return serve(options); });
}
