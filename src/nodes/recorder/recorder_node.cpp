#include "recorder/recorder_node.hpp"

#include "bus_log/instance_end.hpp"
#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "process/host_name.hpp"
#include "process/service.hpp"
#include "recorder/earlier_files.hpp"
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/idl/text.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace sonopose::recorder {
namespace {

namespace topics = dds::topics;

constexpr TimeNs poll_period_ns = 1'000'000'000;

const topics::SerializedTopic& topic_named(const std::string& name) {
  const auto* const topic = topics::find_topic(name);
  if (topic == nullptr) throw std::invalid_argument(name + ": unknown topic");
  return *topic;
}

std::vector<ChannelSpec> channels_of(const std::vector<const topics::SerializedTopic*>& selected,
                                     const dds::qos::Provider& qos) {
  std::vector<ChannelSpec> channels;
  for (const auto* const topic : selected) {
    channels.push_back({.topic = topic->name,
                        .message_encoding = "cdr",
                        .schema_name = topic->type_name,
                        .schema_encoding = "omgidl",
                        .schema_data = std::string(idl::text),
                        .is_latched = topic->is_latched(qos)});
  }
  channels.push_back({.topic = std::string(bus_log::instance_ends_topic),
                      .message_encoding = std::string(bus_log::instance_ends_encoding),
                      .schema_name = std::string(bus_log::instance_end_schema_name),
                      .schema_encoding = std::string(bus_log::instance_end_schema_encoding),
                      .schema_data = std::string(bus_log::instance_end_schema)});
  return channels;
}

bool is_numbered(const RecorderOptions& options) {
  return options.max_size_bytes > 0 || options.max_duration_s > 0 || options.max_total_bytes > 0 ||
         options.keep_last_s > 0;
}

void check_limits(const RecorderOptions& options) {
  if (options.max_files > 0 && !is_numbered(options)) {
    throw std::invalid_argument("--max-files: needs --max-size, --max-duration, --max-total or --keep-last");
  }
  if (options.includes_earlier && options.max_files == 0 && options.max_total_bytes == 0) {
    throw std::invalid_argument("--include-earlier: needs --max-files or --max-total");
  }
  if (options.max_total_bytes > 0 && options.max_size_bytes > options.max_total_bytes / 2) {
    throw std::invalid_argument("--max-total: must be at least twice --max-size");
  }
}

/// `suffix` is appended to the name of the file.
SeriesOptions series_options(const RecorderOptions& options, std::uint32_t domain_id,
                             const std::string& suffix = {}) {
  constexpr std::uint64_t files_of_total = 10;  // without a limit of a file
  std::filesystem::path file = options.file;
  file.replace_filename(file.stem().string() + suffix + file.extension().string());
  return {
      .file = file,
      .writer = {.profile = {}, .library = "sonopose " + options.version, .compression = options.compression},
      .channels = {},
      .about = {{"host", process::host_name()},
                {"version", options.version},
                {"command", options.command},
                {"domain", std::to_string(domain_id)}},
      .is_numbered = is_numbered(options),
      .max_size_bytes =
          options.max_size_bytes > 0 ? options.max_size_bytes : options.max_total_bytes / files_of_total,
      .max_duration_ns = to_ns(options.max_duration_s),
      .max_files = options.max_files,
      .max_total_bytes = options.max_total_bytes,
      .earlier = options.includes_earlier ? find_earlier_files(file, options.is_named_by_time)
                                          : std::deque<RecordedFile>{}};
}

Pipeline::Settings native_settings(const RecorderOptions& options, std::uint32_t domain_id,
                                   std::vector<ChannelSpec> channels) {
  Pipeline::Settings settings{.series = series_options(options, domain_id),
                              .queue_bytes = options.queue_bytes,
                              .ends_channel_id = static_cast<std::uint16_t>(channels.size()),
                              .last = {}};
  settings.series.channels = std::move(channels);
  if (options.keep_last_s > 0) settings.last.emplace(to_ns(options.keep_last_s), options.keep_bytes);
  return settings;
}

/// Settings for the file of ROS 2 topics. They need a file of their own: players of ROS 2 know no other
/// encoding, and an MCAP file has one profile.
Pipeline::Settings ros2_settings(const RecorderOptions& options, std::uint32_t domain_id) {
  Pipeline::Settings settings{.series = series_options(options, domain_id, "_ros2"),
                              .queue_bytes = options.queue_bytes,
                              .ends_channel_id = 0,
                              .last = {}};
  settings.series.writer.profile = "ros2";
  return settings;
}

std::string loss_words(const TapCounts& counts) {
  return fmt::format("{} lost by a full queue, {} dropped by DDS, {} numbered inputs missing",
                     counts.lost_queue, counts.lost_dds, counts.events_missing);
}

}  // namespace

std::vector<const topics::SerializedTopic*> selected_topics(const RecorderOptions& options) {
  std::vector<const topics::SerializedTopic*> selected;
  for (const std::string& name : options.topics) selected.push_back(&topic_named(name));
  if (options.topics.empty()) {
    for (const auto& topic : topics::serialized_topics()) selected.push_back(&topic);
  }
  const topics::SerializedTopic* const settings = &topic_named("settings");
  const auto listed = selected;
  bool records_settings = true;
  for (const std::string& name : options.exclude) {
    const topics::SerializedTopic* const topic = &topic_named(name);
    if (topic == settings) {
      records_settings = false;
    } else if (std::ranges::count(listed, topic) == 0) {
      throw std::invalid_argument(fmt::format("--exclude: {} is not among --topics", name));
    }
    std::erase(selected, topic);
  }
  if (selected.empty()) throw std::invalid_argument("--exclude: no topic is left");
  // A recording of inputs is of little use without the settings.
  if (records_settings) selected.push_back(settings);
  std::sort(selected.begin(), selected.end());
  selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
  return selected;
}

namespace {

/// Selects the topics. Also throws std::invalid_argument if a trigger could never fire, and if the limits do
/// not fit each other.
std::vector<const topics::SerializedTopic*> checked_topics(const RecorderOptions& options) {
  check_limits(options);
  auto selected = selected_topics(options);
  const auto require = [&](const std::string& option, const std::string& topic) {
    if (std::find(selected.begin(), selected.end(), &topic_named(topic)) != selected.end()) return;
    throw std::invalid_argument(fmt::format("{}: the topic {} is not recorded", option, topic));
  };
  if (!options.trigger_topic.empty()) require("--trigger-topic", options.trigger_topic);
  if (options.trigger_on_status) require("--trigger-status", "pose");
  return selected;
}

}  // namespace

Recorder::Recorder(const RecorderOptions& options)
    : options_(options),
      qos_(options.qos_file),
      selected_(checked_topics(options)),
      participant_(dds::ext::participant(options.domain)),
      discovery_(participant_, [this] { news_.wake(); }),
      native_(native_settings(options, participant_.domain_id(), channels_of(selected_, qos_)), trigger_,
              news_),
      began_(clocks::steady_now()) {
  if (options.ros2) {
    ros2_.emplace(ros2_settings(options, participant_.domain_id()), trigger_, news_);
    ros2_topics_.emplace(*ros2_, participant_, qos_);
  }
  for (std::size_t i = 0; i < selected_.size(); ++i) {
    const topics::SerializedTopic& topic = *selected_[i];
    const bool is_map = topic.name == std::string_view(topics::stationary_beacon.name);  // of every beacon
    native_.record({.name = topic.name,
                    .has_beacon = topic.has_beacon && !is_map,
                    .beacons = &options_.beacons,
                    .is_exclusive = topic.is_exclusive(qos_),
                    .trigger = trigger_of(topic)},
                   static_cast<std::uint16_t>(i + 1),
                   [&](dds::sub::DataReaderListener<dds::Serialized>* listener) {
                     return topic.make_reader(participant_, qos_, listener);
                   });
  }
  // Start last, since everything before may fail: the queue holds early messages.
  native_.open();
  if (ros2_) ros2_->open();
  native_.start();
  if (ros2_) ros2_->start();
}

TopicTrigger* Recorder::trigger_of(const topics::SerializedTopic& topic) {
  if (!options_.trigger_topic.empty() && &topic == &topic_named(options_.trigger_topic)) return &any_sample_;
  if (options_.trigger_on_status && &topic == &topic_named("pose")) return &bad_status_;
  return nullptr;
}

TapCounts Recorder::counts() const {
  TapCounts sum = native_.counts();
  if (ros2_) sum += ros2_->counts();
  return sum;
}

bool Recorder::has_failed() const {
  return native_.failure() || (ros2_ && ros2_->failure());
}

void Recorder::run(const process::StopSignal& stop) {
  const SteadyTime end = options_.duration_s > 0 ? began_ + to_ns(options_.duration_s) : SteadyTime::max();
  report_begin();
  process::report_ready();
  try {
    while (!stop.requested() && clocks::steady_now() < end && !has_failed()) {
      const auto writers = discovery_.writers();
      if (ros2_topics_) ros2_topics_->update(writers);
      report_foreign(writers);
      report_news();
      report_rate();
      logging::report_left_out();
      const SteadyTime now = clocks::steady_now();
      stop.wait_until(std::min({end, now + poll_period_ns, process::report_progress_by(now)}), news_);
    }
  } catch (const std::exception&) {
    failure_ = std::current_exception();
  }
}

void Recorder::report_begin() const {
  if (options_.keep_last_s > 0) {
    logging::info(fmt::format("recording the last {} s of {} in memory", options_.keep_last_s,
                              text::count_text(selected_.size(), "topic")));
  } else {
    logging::info(fmt::format("recording {} to {}", text::count_text(selected_.size(), "topic"),
                              native_.series().part().string()));
  }
}

void Recorder::report_foreign(std::vector<dds::FoundEndpoint> writers) {
  if (ros2_topics_) {
    std::erase_if(writers, [this](const auto& writer) { return ros2_topics_->contains(writer.topic_name); });
  }
  for (const std::string& line : foreign_.update(writers, ros2_topics_.has_value())) logging::info(line);
}

/// Reports news for the user: writers that do not match, and losses.
void Recorder::report_news() {
  const std::uint64_t incompatible = native_.incompatible() + (ros2_ ? ros2_->incompatible() : 0);
  if (std::exchange(incompatible_reported_, incompatible) != incompatible) {
    logging::warning("a writer offers incompatible QoS and is not recorded; run sonopose-doctor for details");
  }
  const TapCounts now = counts();
  const TapCounts before = std::exchange(reported_, now);
  if (now.lost_queue != before.lost_queue || now.lost_dds != before.lost_dds ||
      now.events_missing > before.events_missing) {
    logging::warning("the recording lacks messages: " + loss_words(now));
  }
}

/// Says once how much the recording takes: many beacons fill a disk within hours.
void Recorder::report_rate() {
  constexpr double after_s = 60;
  constexpr double day_s = 86400;
  constexpr double hour_s = 3600;
  const double duration_s = seconds_between(began_, clocks::steady_now());
  if (is_rate_reported_ || options_.keep_last_s > 0 || duration_s < after_s) return;
  is_rate_reported_ = true;
  const auto bytes = native_.series().byte_count() + (ros2_ ? ros2_->series().byte_count() : 0);
  const double rate = static_cast<double>(bytes) / duration_s;
  std::error_code unknown;
  const auto space = std::filesystem::space(std::filesystem::absolute(options_.file).parent_path(), unknown);
  const bool has_limit = options_.max_total_bytes > 0 || unknown || rate <= 0;
  logging::info(fmt::format("the recording takes {:.1f} GB a day{}", rate * day_s * 1e-9,
                            has_limit
                                ? ""
                                : fmt::format("; the disk has space for {:.1f} h (--max-total limits it)",
                                              static_cast<double>(space.available) / rate / hour_s)));
}

mcap::TextMap Recorder::foreign_text() const {
  std::string text;
  for (const auto& [topic, writers] : foreign_.writer_counts()) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", topic, text::count_text(writers, "writer"));
  }
  if (foreign_.unnamed() > 0) text += fmt::format(", and {} more", foreign_.unnamed());
  return text.empty() ? mcap::TextMap{} : mcap::TextMap{{"not_recorded", text}};
}

RecorderReport Recorder::finish() {
  const double duration_s = static_cast<double>(clocks::steady_now() - began_) * 1e-9;
  try {
    report_foreign(discovery_.writers());
  } catch (const std::exception&) {
    if (!failure_) failure_ = std::current_exception();
  }
  RecorderReport report;
  report.duration_s = duration_s;
  report.foreign_topics = foreign_.writer_counts();
  report.unnamed_topics = foreign_.unnamed();
  for (Pipeline* const pipeline : {&native_, ros2_ ? &*ros2_ : nullptr}) {
    if (pipeline == nullptr) continue;
    const auto failure = pipeline->finish(foreign_text(), failure_);
    if (!report.failure) report.failure = failure;
    report.counts += pipeline->counts();
    report.recorded += pipeline->series().message_count();
    report.bytes += pipeline->series().byte_count();
    report.lost_disk += pipeline->series().lost_disk();
    report.received.merge(pipeline->received());
    for (const auto& file : pipeline->series().files()) report.files.push_back(file);
    report.removed_files += pipeline->series().removed_files();
  }
  report.only_left_out = native_.only_left_out();
  report_news();
  return report;
}

}  // namespace sonopose::recorder
