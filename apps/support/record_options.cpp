#include "record_options.hpp"

#include "compression_option.hpp"
#include "run.hpp"
#include "topic_option.hpp"

namespace sonopose::apps {
namespace {

/// Lower limit for a file and for memory: a second of several beacons.
constexpr double min_bytes = 1e6;

}  // namespace

void add_file_options(CommandLine& app, recorder::RecorderOptions& options) {
  add_compression_option(app, options.compression);
  app.add_option("--max-size", options.max_size_bytes,
                 "Begin another file before one is larger, such as 500MB")
      .transform(size_between(min_bytes))
      .type_name("SIZE");
  app.add_option("--max-duration", options.max_duration_s, "Begin another file after this many seconds")
      .check(number_between(1.0, 1e9))
      .type_name("S");
  app.add_option("--max-files", options.max_files, "Remove the oldest file before there are more than these")
      .check(number_between(2, 1'000'000))
      .type_name("N");
  app.add_option("--max-total", options.max_total_bytes,
                 "Remove the oldest files before all together are larger, such as 100GB")
      .transform(size_between(10 * min_bytes))
      .type_name("SIZE");
  app.add_flag("--include-earlier", options.includes_earlier,
               "These two limits include the files of earlier recordings of this name, at any time");
}

void add_last_options(CommandLine& app, recorder::RecorderOptions& options) {
  Option keep = app.add_option("--keep-last", options.keep_last_s,
                               "Keep this many seconds in memory, and write them on SIGUSR1 or a trigger")
                    .check(number_between(1.0, 86400.0))
                    .type_name("S")
                    .excludes(app.option("--ros2"));
  app.add_option("--keep-memory", options.keep_bytes, "The memory for --keep-last [256MB]")
      .transform(size_between(min_bytes))
      .type_name("SIZE")
      .needs(keep);
  app.add_option("--trigger-topic", options.trigger_topic,
                 "Write the last seconds at each sample of this topic")
      .check(topic_name())
      .type_name("TOPIC")
      .needs(keep);
  app.add_flag(
         "--trigger-status", options.trigger_on_status,
         "Write the last seconds when a pose becomes stale, frozen, doubted or overloaded, or lacks IMU "
         "samples")
      .needs(keep);
}

}  // namespace sonopose::apps
