// sonopose-web: a live page of every beacon on the bus for the browser, and the topics for Foxglove.

#include "doctor/probe/doctor_node.hpp"
#include "doctor/rules/report.hpp"
#include "process/realtime.hpp"
#include "support/bag_options.hpp"
#include "support/bus_options.hpp"
#include "support/expanded_option.hpp"
#include "support/log_option.hpp"
#include "support/options_file.hpp"
#include "support/version.hpp"
#include "support/waiting.hpp"
#include "web/recording_node.hpp"
#include "web/web_node.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

using namespace sonopose;

namespace {

/// The arguments before they are parsed into options.
struct Given {
  std::string listen;
  std::string floor_plan;
  std::vector<double> floor_plan_area_m;
  std::string geofence;
  std::vector<std::filesystem::path> recording;
  std::optional<BeaconAddress> beacon;
};

void apply(const Given& given, web::WebOptions& options) {
  auto& server = options.server;
  if (!given.listen.empty()) server.endpoint = web::http::parse_endpoint(given.listen);
  for (std::string& origin : server.origins) origin = web::http::parse_origin(origin);
  // The token controls access: its holder sees the page, and changes settings with --allow-changes.
  if (server.token.empty() && !is_loopback(server.endpoint)) server.token = web::http::random_token();
  if (!given.floor_plan.empty()) {
    options.map.floor_plan = web::read_floor_plan(given.floor_plan, given.floor_plan_area_m);
  }
  if (!given.geofence.empty()) options.map.geofence_m = web::read_geofence(given.geofence);
}

}  // namespace

int main(int argc, char** argv) {
  apps::BusOptions bus;
  web::WebOptions options;
  Given given;
  apps::Program app("web", "Only this machine can open the page unless --listen says otherwise.");
  auto recording =
      app.add_option("recording", given.recording,
                     "Show this instead of the bus: MCAP or rosbag2 files or a sensor-log folder");
  apps::add_expanded_option(app);
  apps::add_bag_options(app);
  app.add_option("--beacon", given.beacon,
                 "Only this beacon; required if the recording has several and no poses")
      .type_name("ADDRESS")
      .needs(recording);
  add_bus_options(app, bus);
  logging::Level log_level = logging::Level::info;
  apps::add_log_option(app, log_level);
  add_max_beacons(app, "Show", options.max_beacons);
  app.add_option("--listen", given.listen, "Where to serve the page")
      .check(apps::readable_by(web::http::parse_endpoint))
      .type_name("ADDRESS:PORT")
      .default_str(text_of(options.server.endpoint));
  app.add_option("--token", options.server.token,
                 "Secret in the page's URL; if other machines can connect, a random token is generated")
      .check(apps::readable_by(web::http::check_token))
      .type_name("TEXT");
  app.add_option("--allow-origin", options.server.origins,
                 "A page elsewhere that may use Foxglove's protocol; file:// for local ones")
      .check(apps::readable_by(web::http::parse_origin))
      .type_name("URL");
  app.add_flag("--allow-changes", options.allows_changes,
               "The page may change settings and reset estimators");
  app.add_option("--max-clients", options.server.max_clients, "Pages and Foxglove clients at a time")
      .check(apps::number_between(1, 1000))
      .capture_default_str();
  app.add_option("--on-status", options.on_status,
                 "Run this with sh when a beacon's status changes, at most every 10 s; see docs/web.md")
      .type_name("COMMAND");
  auto plan = app.add_option("--floor-plan", given.floor_plan, "A picture under the map: PNG, JPEG or SVG")
                  .check(apps::readable_by(web::read_picture))
                  .type_name("FILE");
  app.add_option("--floor-plan-area", given.floor_plan_area_m,
                 "Where its lower left and upper right corners are, in m")
      .type_name("X0 Y0 X1 Y1")
      .expected(4)
      .needs(plan);
  plan.needs(app.option("--floor-plan-area"));
  app.add_option("--geofence", given.geofence, "The corners of an area, as CSV with the header # x_m,y_m")
      .check(apps::readable_by(web::read_geofence))
      .type_name("FILE");
  apps::add_options_file(app);
  for (const apps::Option& option : app.options()) {
    const bool is_of_bus = option.group_name() == apps::bus_group;
    const bool is_of_live_page = option.has_name("--allow-changes") || option.has_name("--max-beacons") ||
                                 option.has_name("--on-status");
    if (is_of_bus || is_of_live_page) recording.excludes(option);
  }
  return apps::run(app, argc, argv, [&] {
    process::use_batch_scheduling();  // only watches
    const logging::Session log(log_level);
    apply(given, options);
    std::optional<apps::Waiting> reading;
    const auto report = [log_level, &reading](const std::vector<std::string>& urls) {
      reading.reset();
      for (const std::string& url : urls) {
        // Logs are kept and copied, so they do not have the token, which nobody can guess.
        const bool has_token = url.find('?') != std::string::npos;
        if (has_token || log_level > logging::Level::info) apps::print("{}\n", url);
        std::fflush(stdout);
        logging::info("the page is at " + url.substr(0, url.find('?')) +
                      (has_token ? " with the token on standard output" : ""));
      }
    };
    process::StopSignal stop;
    if (!given.recording.empty()) {
      reading.emplace("reading " + given.recording.front().string());
      web::serve_recording({.recording = given.recording,
                            .beacon = given.beacon,
                            .server = options.server,
                            .map = options.map,
                            .version = std::string(apps::version())},
                           report, stop);
      return 0;
    }
    stop.listen_to_signals();
    if (!apps::wait_for_network(bus.domain, stop)) return 0;
    options.domain = bus.domain;
    options.qos_file = bus.qos_file;
    options.version = apps::version();
    options.examine = [&bus](double duration_s, const process::StopSignal& stopped) {
      return json_of(diagnose(doctor::probe::observe(
          {.domain = bus.domain, .qos_file = bus.qos_file, .duration_s = duration_s}, stopped)));
    };
    web::serve(options, report, stop);
    return 0;
  });
}
