// sonopose-play: publishes a recording in MCAP files on the bus.

#include "player/player_node.hpp"
#include "support/bus_options.hpp"
#include "support/expanded_option.hpp"
#include "support/log_option.hpp"
#include "support/moment_option.hpp"
#include "support/topic_option.hpp"
#include "support/waiting.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <optional>

namespace {

using namespace sonopose;

struct Options {
  apps::BusOptions bus;
  player::PlayerOptions player;
  bool no_wait = false;
  logging::Level log_level = logging::Level::info;
};

int serve(Options& options) {
  const logging::Session log(options.log_level);
  apps::check_publisher(options.bus);
  options.player.domain = options.bus.domain;
  options.player.qos_file = options.bus.qos_file;
  options.player.wait_for_readers = !options.no_wait;
  process::StopSignal stop;
  apps::wait_for_network(options.player.domain, stop);  // a signal ends the process until the files are read
  player::PlayControl control;
  std::optional<player::Keys> keys;
  std::optional<apps::Waiting> reading("reading the recording");
  options.player.on_read = [&] {
    reading.reset();
    stop.listen_to_signals();  // before, a signal ends the process immediately
    keys.emplace(control, stop);
    if (keys->are_read()) logging::info("space: pause and continue; s: one message; q: quit");
  };
  const auto report = player::play(options.player, control, stop);
  apps::print("played {} in {:.1f} s\n", text::count_text(report.played, "message"), report.duration_s);
  if (report.refused > 0) {
    apps::print("refused (wrong type for the topic): {}\n", text::count_text(report.refused, "message"));
  }
  if (report.shortened_gaps > 0) {
    apps::print("shortened: {}, by {:.1f} s\n", text::count_text(report.shortened_gaps, "gap"),
                report.left_out_s);
  }
  if (report.damaged > 0) apps::print("not played: {}\n", text::count_text(report.damaged, "damaged chunk"));
  if (report.lost_by_fusions > 0) {
    apps::print("lost by fusions without --lossless: {}\n",
                text::count_text(report.lost_by_fusions, "event"));
  }
  return report.refused == 0 && report.damaged == 0 && report.lost_by_fusions == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  player::PlayerOptions& player = options.player;
  apps::Program app("play",
                    "On a terminal the space bar pauses and continues, s plays one message, q quits.");
  app.add_option("file", player.recording, "The recording: MCAP files, or a folder of them")
      .required()
      .type_name("FILE");
  apps::add_bus_options(app, options.bus);
  apps::add_log_option(app, options.log_level);
  app.add_option("--rate", player.rate,
                 "1: real time; 10: ten times as fast; 0: as fast as the readers (a fusion needs --lossless)")
      .check(apps::number_between(0.0, 1e6))
      .capture_default_str();
  app.add_flag("--loop", player.loop, "Restart at the end, until stopped");
  apps::add_span_options(app, player.start, player.end);
  apps::add_expanded_option(app);
  app.add_option("--max-gap", player.max_gap_s, "Shorten longer times without a message to this one")
      .check(apps::number_between(0.0, 1e9))
      .type_name("S");
  app.add_option("--topics", player.topics, "Only these topics")
      .delimiter(',')
      .check(apps::topic_name())
      .type_name("TOPIC,...");
  app.add_flag("--restamp", player.restamp, "Move all times in the messages to now");
  auto no_wait = app.add_flag("--no-wait", options.no_wait, "Do not wait for the first reader");
  app.add_option("--readers", player.readers, "Wait until each played topic has this many readers")
      .check(apps::number_between(1, 1000))
      .type_name("N")
      .excludes(no_wait);
  return apps::run(app, argc, argv, [&] { return serve(options); });
}
