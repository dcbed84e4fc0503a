// sonopose-mcap: shows recordings of the bus, and converts them into others.

#include "bus_log/copy.hpp"
#include "bus_log/messages.hpp"
#include "bus_log/recording_files.hpp"
#include "bus_log/summary.hpp"
#include "evaluation/report/exported.hpp"
#include "logging/log.hpp"
#include "mcap/reader.hpp"
#include "mcap/verify.hpp"
#include "support/bag_options.hpp"
#include "support/compression_option.hpp"
#include "support/expanded_option.hpp"
#include "support/moment_option.hpp"
#include "support/progress.hpp"
#include "support/run.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace sonopose;
using Path = std::filesystem::path;

struct Options {
  std::vector<Path> files;
  Path out;
  bus_log::Choice choice;
  mcap::Compression compression = mcap::Compression::lz4;
  bool json = false;
  bool verify = false;
};

void warn(const std::vector<std::string>& damages) {
  for (const std::string& damage : damages) logging::warning("damaged: " + damage);
}

int info(const Options& options) {
  bool is_sound = true;
  const std::vector<Path> files = bus_log::recording_files(options.files);
  for (const Path& file : files) {
    const mcap::Reader reader(file);
    const auto damages = options.verify ? mcap::verify(reader) : std::vector<std::string>{};
    is_sound = is_sound && (!options.verify || bus_log::is_sound(reader, damages));
    apps::print("{}{}", options.json || &file == &files.front() ? "" : "\n",
                options.json ? bus_log::summary_json(reader, damages) + "\n"
                             : bus_log::summary_text(reader, damages));
  }
  return is_sound ? 0 : 1;
}

int cat(const Options& options) {
  const mcap::Reader reader(bus_log::recording_files(options.files));
  warn(reader.damages());
  bus_log::ChosenMessages messages(reader, options.choice);
  bool has_printed = false;
  for (bus_log::MessageLines lines(reader); const auto chosen = messages.next(); has_printed = true) {
    apps::print("{}\n", lines.line_of(*chosen->channel, chosen->message));
    if (std::ferror(stdout) != 0) return 0;  // reported at the end
  }
  return has_printed ? 0 : throw bus_log::nothing_selected({&reader}, reader.statistics().message_count);
}

int copy(const Options& options, mcap::Selection::Damaged damaged, bool is_one_recording) {
  apps::Progress progress;
  const auto result = bus_log::copy({options.files, options.out, options.choice, options.compression, damaged,
                                     [&](double share) { progress.at(share, "copying"); }, is_one_recording});
  progress.clear();
  warn(result.damages);
  apps::print("{}: {} of {}{}, {}, {}\n", options.out.string(), result.messages,
              result.has_uncounted_loss ? "at least " : "", text::count_text(result.stated, "message"),
              text::count_text(result.metadata, "metadata record"),
              text::count_text(result.attachments, "attachment"));
  return 0;
}

int export_files(const Options& options) {
  const auto result = evaluation::export_recording(options.files, options.choice.beacon, options.out);
  apps::print("{}: {}, {}, {}\n", options.out.string(), text::count_text(result.events, "event"),
              text::count_text(result.poses, "pose"), text::count_text(result.reports, "report"));
  return result.misread == 0 ? 0 : 1;
}

void add_beacon(apps::CommandLine& command, Options& options, const char* description) {
  command.add_option("--beacon", options.choice.beacon, description).check(apps::number_between(0, 65534));
}

void add_choice_options(apps::CommandLine& command, Options& options) {
  command.add_option("--topics", options.choice.topics, "Only these topics: imu,fix or sonopose/imu")
      .delimiter(',')
      .type_name("TOPIC,...");
  add_beacon(command, options, "Only the messages of this beacon");
  apps::add_span_options(command, options.choice.start, options.choice.end);
}

apps::CommandLine add_command(apps::CommandLine& app, Options& options, const char* name,
                              const char* description, int max_files = apps::any_number) {
  auto command = app.add_subcommand(name, description);
  command.add_option("FILE", options.files, max_files == 1 ? "MCAP file" : "MCAP files or a folder of them")
      .required()
      .expected(1, max_files)
      .type_name("FILE");
  apps::add_expanded_option(command);
  return command;
}

void add_output(apps::CommandLine& command, Options& options, bool is_file) {
  command
      .add_option("--out", options.out,
                  is_file ? "The file to write; it must not exist" : "The folder to write")
      .required()
      .type_name(is_file ? "FILE" : "DIR");
  if (is_file) apps::add_compression_option(command, options.compression);
}

}  // namespace

int main(int argc, char** argv) {
  using enum mcap::Selection::Damaged;
  Options options;
  apps::Program app("mcap");
  app.require_subcommand();
  auto shown = add_command(app, options, "info", "Print what files have: times, topics, metadata");
  shown.add_flag("--json", options.json, "Print one JSON object for each file");
  shown.add_flag("--verify", options.verify, "Read all of a file; the exit code is 1 if it is damaged");
  auto lines = add_command(app, options, "cat", "Print each message as a line of JSON, by time");
  add_choice_options(lines, options);
  auto filter = add_command(app, options, "filter", "Write some of the messages to another file");
  add_choice_options(filter, options);
  add_output(filter, options, true);
  auto merge = add_command(app, options, "merge", "Write several files to one, by time");
  add_output(merge, options, true);
  auto recover = add_command(app, options, "recover", "Write what is readable of a damaged file", 1);
  add_output(recover, options, true);
  auto exporting =
      add_command(app, options, "export", "Write one beacon as CSV log folder, and its poses as TUM");
  add_beacon(exporting, options, "The beacon, if the file has several");
  add_output(exporting, options, false);
  apps::add_bag_options(exporting);
  return apps::run(app, argc, argv, [&] {
    if (shown.parsed() || lines.parsed()) return shown.parsed() ? info(options) : cat(options);
    if (exporting.parsed()) return export_files(options);
    return copy(options, recover.parsed() ? skip : refuse, filter.parsed());
  });
}
