// sonopose-monitor: a live table of every beacon on the bus.

#include "monitor/monitor_node.hpp"
#include "support/bus_options.hpp"

#include <unistd.h>

int main(int argc, char** argv) {
  sonopose::apps::BusOptions bus;
  sonopose::monitor::MonitorOptions options;
  sonopose::apps::Program app("monitor", "It prints a summary at the end.");
  add_bus_options(app, bus);
  app.add_flag("--json", options.json, "Print one JSON object per second instead of the table");
  add_max_beacons(app, "Show", options.max_beacons);
  app.add_option("--duration", options.duration_s, "Exit after this many seconds; 0: run until stopped")
      ->check(sonopose::apps::number_between(0.0))
      ->capture_default_str();
  return sonopose::apps::run(app, argc, argv, [&] {
    options.domain = bus.domain;
    options.qos_file = bus.qos_file;
    options.redraw = !options.json && ::isatty(STDOUT_FILENO) == 1;
    sonopose::process::StopSignal stop;
    stop.listen_to_signals();
    const auto poses = sonopose::monitor::monitor(options, stop);
    return poses > 0 || stop.requested() ? 0 : 1;  // no pose in the whole duration is an error
  });
}
