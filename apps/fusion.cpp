// sonopose-fusion: subscribes to the bridge's samples and publishes the fused pose of every beacon.

#include "support/app.hpp"
#include "support/config_options.hpp"
#include "support/realtime_option.hpp"
#include <sonopose/nodes/fusion_node.hpp>

#include <fmt/format.h>

#include <cstdio>

namespace {

struct Options {
  sonopose::apps::BusOptions bus;
  sonopose::apps::ConfigOptions config;
  bool lossless = false;
  int realtime_priority = 0;
  bool print_config = false;
  bool print_settings_page = false;
};

int serve(const CLI::App& app, const Options& options) {
  if (options.print_settings_page) {
    fmt::print("{}", sonopose::config::settings_page());
    return 0;
  }
  const auto config = sonopose::apps::configuration(app, options.config);
  if (options.print_config) {
    fmt::print("{}", config.to_toml());
    return 0;
  }
  sonopose::nodes::StopSignal stop;
  stop.listen_to_signals();
  sonopose::nodes::FusionNode node({options.bus.domain, options.bus.qos_file, config, options.lossless});
  const auto realtime = sonopose::apps::realtime(app, options.realtime_priority);
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
  sonopose::apps::add_realtime_option(app, options.realtime_priority);
  sonopose::apps::add_config_options(app, options.config);
  app.add_flag("--lossless", options.lossless,
               "Keep every event and pose and wait for slow consumers: for a log played at --rate 0");
  app.add_flag("--print-config", options.print_config, "Print the settings as commented TOML and end");
  app.add_flag("--print-settings-page", options.print_settings_page,
               "Print the table of all settings as a page of the docs and end");
  return sonopose::apps::run(app, argc, argv, [&] { return serve(app, options); });
}
