// sonopose-bridge: reads beacons (or a recording, or the simulator) and publishes their samples.

#include "publication/sensor_publisher.hpp"
#include "support/bus_options.hpp"
#include "support/log_option.hpp"
#include "support/options_file.hpp"
#include "support/realtime_option.hpp"
#include "support/source_options.hpp"

namespace {

using namespace sonopose;

struct Options {
  apps::BusOptions bus;
  apps::SourceOptions source;
  std::optional<std::filesystem::path> record;
  int realtime_priority = 0;
  logging::Level log_level = logging::Level::info;
};

/// Finishes both: an error of the capture must not prevent the end of the recording.
void finish(publication::Source& source, publication::SensorPublisher& node) {
  try {
    source.finish();
  } catch (...) {
    node.finish();
    throw;
  }
  node.finish();
}

int serve(const apps::CommandLine& app, const Options& options) {
  const logging::Session log(options.log_level);
  apps::check_publisher(options.bus);
  apps::check_source_options(app, options.source);
  process::StopSignal stop;  // outlives the source, whose capture checks it until the end
  const auto source = apps::make_source(options.source);
  stop.listen_to_signals();
  if (!apps::wait_for_network(options.bus.domain, stop)) return 0;
  publication::SensorPublisher node(options.bus.domain,
                                    {.qos_file = options.bus.qos_file,
                                     .lossless = options.source.is_unpaced(),
                                     .batch = options.source.is_many(),
                                     .record_folder = options.record,
                                     .source_settings = apps::source_settings(app, options.source)});
  const auto realtime = apps::realtime(options.realtime_priority);
  // A serial line says when its device is open.
  if (options.source.source != "serial") logging::info("publishing from " + options.source.source);
  apps::serve([&] { node.run(*source, stop); });
  finish(*source, node);
  return node.lost_by_fusions() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("bridge");
  apps::add_bus_options(app, options.bus);
  apps::add_realtime_option(app, options.realtime_priority);
  apps::add_log_option(app, options.log_level);
  apps::add_source_options(app, options.source);
  app.add_option("--record", options.record, "Write the published samples to a new sensor-log folder")
      .type_name("DIR");
  apps::add_options_file(app);
  return apps::run(app, argc, argv, [&] { return serve(app, options); });
}
