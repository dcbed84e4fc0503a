// sonopose-monitor: a live view of every beacon on the bus, or the samples of one topic.

#include "monitor/echo/echo.hpp"
#include "monitor/monitor_node.hpp"
#include "process/realtime.hpp"
#include "support/bus_options.hpp"
#include "support/log_option.hpp"
#include "support/topic_option.hpp"
#include "terminal/terminal.hpp"

#include <fmt/format.h>

using namespace sonopose;

int main(int argc, char** argv) {
  apps::BusOptions bus;
  monitor::MonitorOptions options;
  monitor::echo::EchoOptions echo;
  bool json = false;
  double duration_s = 0.0;
  apps::Program app(
      "monitor",
      "On a terminal it fills the screen (? shows the keys); elsewhere it prints a table per second. "
      "It prints a summary at the end.");
  add_bus_options(app, bus);
  logging::Level log_level = logging::Level::info;
  apps::add_log_option(app, log_level);
  apps::Option json_option = app.add_flag("--json", json, "Print one JSON object per second");
  add_max_beacons(app, "Show", options.max_beacons);
  app.add_option("--duration", duration_s, "Exit after this many seconds; 0: run until stopped")
      .check(apps::number_between(0.0))
      .capture_default_str();
  apps::Option topic =
      app.add_option("--echo", echo.topic, "Print each sample of a topic as a JSON object on a line")
          .check(apps::topic_name())
          .type_name("TOPIC")
          .excludes(json_option);
  app.add_option("--beacon", echo.beacon, "With --echo: only the samples of this beacon")
      .type_name("ADDRESS")
      .needs(topic);
  app.add_option("--count", echo.count, "With --echo: exit after this many samples; 0: no limit")
      .check(apps::number_between(0, 1e9))
      .type_name("N")
      .needs(topic);
  return apps::run(app, argc, argv, [&] {
    process::use_batch_scheduling();  // each sample wakes the monitor and the fusion at the same time
    const logging::Session log(log_level);
    process::StopSignal stop;
    stop.listen_to_signals();
    if (!apps::wait_for_network(bus.domain, stop, duration_s)) return 0;
    if (!echo.topic.empty()) {
      echo.domain = bus.domain;
      echo.qos_file = bus.qos_file;
      echo.duration_s = duration_s;
      if (monitor::echo::echo(echo, stop)) return 0;
      const std::string beacon = echo.beacon ? fmt::format(" of beacon {}", *echo.beacon) : "";
      logging::failure(fmt::format("no sample of {}{} in {} s in domain {}; sonopose-doctor may say why",
                                   echo.topic, beacon, duration_s,
                                   sonopose::dds::resolve_domain_id(bus.domain)));
      return 1;
    }
    options.domain = bus.domain;
    options.qos_file = bus.qos_file;
    options.duration_s = duration_s;
    options.output = json                    ? monitor::Output::json
                     : terminal::is_screen() ? monitor::Output::screen
                                             : monitor::Output::table;
    const auto poses = monitor::monitor(options, stop);
    return poses > 0 || stop.requested() ? 0 : 1;  // a whole duration without a pose is an error
  });
}
