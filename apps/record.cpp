// sonopose-record: records any topics of the bus to MCAP files.

#include "clocks/clocks.hpp"
#include "recorder/recorder_node.hpp"
#include "recorder/signal_trigger.hpp"
#include "support/bus_options.hpp"
#include "support/log_option.hpp"
#include "support/options_file.hpp"
#include "support/record_options.hpp"
#include "support/topic_option.hpp"
#include "support/version.hpp"
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <csignal>
#include <ctime>
#include <exception>
#include <optional>

namespace {

using namespace sonopose;

struct Options {
  apps::BusOptions bus;
  recorder::RecorderOptions recorder;
  std::string beacons;
  logging::Level log_level = logging::Level::info;
};

/// Returns a name by the second of the start, so that files sort by time.
std::string name_by_time() {
  const auto now_s = static_cast<std::time_t>(clocks::host_now() / 1'000'000'000);
  std::tm utc{};
  ::gmtime_r(&now_s, &utc);
  return fmt::format("sonopose_{:04}-{:02}-{:02}_{:02}-{:02}-{:02}.mcap", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

void print(const recorder::RecorderReport& report) {
  for (const auto& [topic, count] : report.received) {
    if (count > 0) apps::print("{:28} {:>10}\n", topic, count);
  }
  std::vector<std::string> files;
  for (const auto& file : report.files) files.push_back(file.string());
  apps::print("recorded {} in {:.1f} s, {:.1f} MB: {}\n", text::count_text(report.recorded, "message"),
              report.duration_s, static_cast<double>(report.bytes) * 1e-6,
              files.empty() ? "no file" : fmt::format("{}", fmt::join(files, ", ")));
  apps::print("lost: {} by a full queue, {} by the disk, {} by DDS\nmissing: {} of beacons\n",
              report.counts.lost_queue, report.lost_disk, report.counts.lost_dds,
              text::count_text(report.counts.events_missing, "input"));
  if (report.removed_files > 0) {
    apps::print("removed: {}\n", text::count_text(report.removed_files, "older file"));
  }
  for (const auto& [topic, writers] : report.foreign_topics) {
    apps::print("not recorded: {} ({})\n", text::escaped(topic), text::count_text(writers, "writer"));
  }
  const std::uint64_t more = report.unnamed_topics;
  if (more > 0) apps::print("not recorded: {}\n", text::count_text(more, "more topic"));
}

int serve(Options& options, const std::string& command) {
  const logging::Session log(options.log_level);
  recorder::RecorderOptions& recording = options.recorder;
  recording.domain = options.bus.domain;
  recording.qos_file = options.bus.qos_file;
  recording.version = apps::version();
  recording.command = command;
  if (!options.beacons.empty()) recording.beacons = presence::AddressSet::parse(options.beacons);
  recording.is_named_by_time = recording.file.empty();
  if (recording.is_named_by_time) recording.file = name_by_time();
  process::StopSignal stop;
  stop.listen_to_signals();
  if (!apps::wait_for_network(recording.domain, stop, recording.duration_s)) return 0;
  recorder::Recorder recorder(recording);
  std::optional<recorder::SignalTrigger> on_signal;
  if (recording.keep_last_s > 0) on_signal.emplace(SIGUSR1, recorder.trigger());
  recorder.run(stop);
  const recorder::RecorderReport report = recorder.finish();
  print(report);
  if (report.failure) std::rethrow_exception(report.failure);
  if (report.recorded == 0 && recording.keep_last_s == 0) {
    logging::warning(fmt::format("nothing is published in domain {}; sonopose-doctor may say why",
                                 sonopose::dds::resolve_domain_id(recording.domain)));
  }
  if (report.only_left_out) {
    logging::error(fmt::format("no message of --beacons {} arrived, but some of beacon {} did",
                               options.beacons, *report.only_left_out));
    return 1;
  }
  return report.is_complete() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGUSR1, SIG_IGN);  // too early, or without --keep-last: otherwise it would end the process
  Options options;
  recorder::RecorderOptions& recording = options.recorder;
  apps::Program app("record", "Ctrl-C ends the recording.");
  app.add_option("file", recording.file, "The file to write [sonopose_DATE_TIME.mcap]").type_name("FILE");
  apps::add_bus_options(app, options.bus);
  apps::add_log_option(app, options.log_level);
  app.add_option("--topics", recording.topics, "Only these topics")
      .delimiter(',')
      .check(apps::topic_name())
      .type_name("TOPIC,...");
  app.add_option("--exclude", recording.exclude, "Not these topics")
      .delimiter(',')
      .check(apps::topic_name())
      .type_name("TOPIC,...");
  app.add_option("--beacons", options.beacons, "Only these beacons, such as 7-131,200")
      .check(apps::readable_by(presence::AddressSet::parse))
      .type_name("LIST");
  app.add_flag("--ros2", recording.ros2,
               "Also the topics of ROS 2, to FILE_ros2.mcap, which its own player plays");
  app.add_option("--duration", recording.duration_s, "End after this many seconds; 0: record until stopped")
      .check(apps::number_between(0.0, 1e9))
      .capture_default_str();
  apps::add_file_options(app, recording);
  apps::add_last_options(app, recording);
  apps::add_options_file(app);
  std::string command = "sonopose-record";
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
  return apps::run(app, argc, argv, [&] { return serve(options, command); });
}
