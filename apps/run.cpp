// sonopose-run: bridge, fusion and monitor of one configuration in one terminal.

#include "launch/together.hpp"
#include "support/bus_options.hpp"
#include "support/config_options.hpp"
#include "support/log_option.hpp"
#include "support/realtime_option.hpp"
#include "support/source_options.hpp"
#include "terminal/terminal.hpp"

#include <optional>
#include <string>
#include <vector>

namespace {

using namespace sonopose;
using Arguments = std::vector<std::string>;

struct Options {
  apps::BusOptions bus;
  apps::SourceOptions source;
  logging::Level log_level = logging::Level::info;
  apps::ConfigOptions config;
  std::optional<std::string> record;
  int realtime_priority = 0;
  bool json = false;
};

Arguments joined(Arguments all, const Arguments& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

int run(const apps::CommandLine& app, const Options& options) {
  apps::check_publisher(options.bus);
  apps::check_source_options(app, options.source);
  const Arguments bus = apps::option_arguments(app, apps::bus_group);
  const Arguments log = apps::option_arguments(app, apps::log_group);
  const Arguments live = joined(joined(bus, apps::option_arguments(app, apps::realtime_group)), log);
  Arguments bridge = joined(live, apps::option_arguments(app, apps::source_group));
  Arguments fusion = joined(live, apps::option_arguments(app, apps::settings_group));
  Arguments monitor = joined(bus, log);
  if (options.record) bridge.push_back("--record=" + *options.record);
  if (options.source.is_unpaced()) fusion.emplace_back("--lossless");
  if (options.json) monitor.emplace_back("--json");
  // The monitor shows its screen if there is a terminal.
  const bool has_screen = !options.json && terminal::is_screen();
  return launch::run_together(
      {{"sonopose-fusion", fusion}, {"sonopose-bridge", bridge}, {"sonopose-monitor", monitor, true}},
      has_screen ? launch::ErrorOutput::keep : launch::ErrorOutput::pass_on);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.bus.joins_bus = false;
  apps::Program app(
      "run",
      "It passes its options on. When one of the three programs ends, or at Ctrl-C, the others end "
      "too. While the monitor has the screen, the lines of the others appear at the end.");
  apps::add_log_option(app, options.log_level);
  apps::add_source_options(app, options.source);
  app.add_option("--record", options.record, "Write the published samples to a new sensor-log folder")
      .type_name("DIR");
  app.add_flag("--json", options.json, "The monitor prints one JSON object per second instead of the table");
  apps::add_config_options(app, options.config);
  apps::add_bus_options(app, options.bus);
  apps::add_realtime_option(app, options.realtime_priority);
  return apps::run(app, argc, argv, [&] { return run(app, options); });
}
