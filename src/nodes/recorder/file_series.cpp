#include "recorder/file_series.hpp"

#include "bus_log/instance_end.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "mcap/chunk_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace sonopose::recorder {
namespace {

constexpr std::string_view settings_topic = "sonopose/settings";

/// Id of a channel; 0 if there is none.
std::uint16_t channel_id_of(const std::vector<ChannelSpec>& channels, std::string_view topic) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].topic == topic) return static_cast<std::uint16_t>(i + 1);
  }
  return 0;
}

bus_log::LatchedSamples latched_samples(const std::vector<ChannelSpec>& channels) {
  std::map<std::uint16_t, const dds::topics::SerializedTopic*> topics;
  for (const ChannelSpec& channel : channels) {
    const auto* const topic = channel.is_latched ? dds::topics::find_topic(channel.topic) : nullptr;
    if (topic != nullptr) topics[channel_id_of(channels, channel.topic)] = topic;
  }
  return {std::move(topics), channel_id_of(channels, bus_log::instance_ends_topic)};
}

TapCounts difference(const TapCounts& now, const TapCounts& before) {
  return {now.received - before.received, now.lost_queue - before.lost_queue, now.lost_dds - before.lost_dds,
          now.events_missing - std::min(now.events_missing, before.events_missing)};  // one may arrive late
}

}  // namespace

FileSeries::FileSeries(SeriesOptions options)
    : options_(std::move(options)),
      latched_(latched_samples(options_.channels)),
      settings_(channel_id_of(options_.channels, settings_topic)) {
  recording::check_part_file(file_of(1));
}

FileSeries::Part::~Part() {
  if (is_kept) return;
  std::error_code error;
  std::filesystem::remove(path, error);
}

/// Number of the next file. Skips existing files: a recording may run for hours before it reaches them.
std::size_t FileSeries::next_number() const {
  std::size_t number = last_number_ + 1;
  while (options_.is_numbered && !recording::is_free_for_part(file_of(number))) ++number;
  return number;
}

std::filesystem::path FileSeries::file_of(std::size_t number) const {
  if (!options_.is_numbered) return options_.file;
  std::filesystem::path file = options_.file;
  file.replace_filename(fmt::format("{}_{:03}{}", file.stem().string(), number, file.extension().string()));
  return file;
}

std::filesystem::path FileSeries::part() const {
  const threads::Lock lock(mutex_);
  return current_ ? current_->name.part() : file_of(next_number()) += ".part";
}

std::array<std::uint16_t, 4> FileSeries::input_channel_ids() const {
  const threads::Lock lock(mutex_);
  return {channel_id_of(options_.channels, "sonopose/imu"), channel_id_of(options_.channels, "sonopose/fix"),
          channel_id_of(options_.channels, "sonopose/heading"),
          channel_id_of(options_.channels, "sonopose/twist")};
}

std::uint16_t FileSeries::ends_channel_id() const {
  const threads::Lock lock(mutex_);
  return channel_id_of(options_.channels, bus_log::instance_ends_topic);
}

std::string FileSeries::topic(std::uint16_t channel_id) const {
  const threads::Lock lock(mutex_);
  return options_.channels.at(channel_id - 1U).topic;
}

void FileSeries::open() {
  const threads::Lock lock(mutex_);
  begin_file();
}

std::uint16_t FileSeries::add_channel(ChannelSpec channel) {
  const threads::Lock lock(mutex_);
  if (current_) add_to_file(channel);
  const bool is_latched = channel.is_latched;
  options_.channels.push_back(std::move(channel));
  const auto id = static_cast<std::uint16_t>(options_.channels.size());
  if (is_latched) latched_.add_plain(id);
  return id;
}

std::uint16_t FileSeries::add_to_file(const ChannelSpec& channel) {
  mcap::Writer& writer = current_->writer;
  const auto schema_id = writer.add_schema(channel.schema_name, channel.schema_encoding, channel.schema_data);
  return writer.add_channel(schema_id, channel.topic, channel.message_encoding, channel.metadata);
}

void FileSeries::begin_file() {
  if (current_) return;
  const std::size_t number = next_number();
  began_.reset();
  repeated_ = 0;
  repeated_lost_ = 0;
  settings_.clear();
  current_.emplace(file_of(number), options_.writer);
  try {
    write_head();
  } catch (...) {
    current_.reset();
    throw;
  }
  last_number_ = number;
}

/// Writes everything that precedes the first message.
void FileSeries::write_head() {
  std::uint16_t expected_id = 0;
  for (const ChannelSpec& channel : options_.channels) {
    const auto id = add_to_file(channel);
    if (id != ++expected_id)
      throw std::logic_error("channel " + channel.topic + " has another number than in the queue");
  }
  mcap::TextMap about = options_.about;
  about["file_index"] = std::to_string(finished_files_ + 1);
  current_->writer.write_metadata({"sonopose.recording", about});
}

void FileSeries::write(const mcap::Chunk& chunk, const ArrivalSpan& taken, const TapCounts& counts) {
  const threads::Lock lock(mutex_);
  if (chunk.is_empty()) return;
  try {
    prepare_for(chunk, taken);
  } catch (const files::IoError&) {
    lost_ += chunk.message_count();
    throw;
  }
  if (!began_) began_ = taken.begin;
  write_chunk(chunk);
  latched_.on(chunk);
  write_losses(counts);
}

void FileSeries::prepare_for(const mcap::Chunk& chunk, const ArrivalSpan& taken) {
  if (const char* const limit = current_ ? limit_of(chunk, taken) : nullptr; limit != nullptr) {
    end_file(limit, counts_reported_, {});
  }
  if (!current_) {
    begin_file();
    write_latched(chunk);
  }
  remove_old(bytes_with(chunk));
}

void FileSeries::remove_old(std::uint64_t current_bytes) {
  std::uint64_t total = current_bytes;
  for (const RecordedFile& each : options_.earlier) total += each.bytes;
  for (const RecordedFile& each : complete_) total += each.bytes;
  while (const std::size_t count = options_.earlier.size() + complete_.size()) {
    const bool are_too_many = options_.max_files > 0 && count >= options_.max_files;
    const bool are_too_large = options_.max_total_bytes > 0 && total > options_.max_total_bytes;
    if (!are_too_many && !are_too_large) return;
    std::deque<RecordedFile>& oldest = options_.earlier.empty() ? complete_ : options_.earlier;
    total -= oldest.front().bytes;
    const std::filesystem::path file = std::move(oldest.front().file);
    oldest.pop_front();
    std::error_code error;
    const bool is_removed = std::filesystem::remove(file, error);
    if (error) {
      logging::warning(fmt::format("{}: cannot be removed: {}; the recording becomes larger than the limit",
                                   file.string(), error.message()));
      continue;
    }
    if (!is_removed) continue;  // by someone else
    ++removed_files_;
    logging::info(fmt::format("{}: removed, the oldest file", file.string()));
  }
}

const char* FileSeries::limit_of(const mcap::Chunk& chunk, const ArrivalSpan& taken) const {
  if (!began_) return nullptr;
  if (options_.max_size_bytes > 0 && bytes_with(chunk) > options_.max_size_bytes) return "size";
  if (options_.max_duration_ns > 0 && taken.end - *began_ > options_.max_duration_ns) return "duration";
  return nullptr;
}

std::uint64_t FileSeries::bytes_with(const mcap::Chunk& chunk) const {
  const mcap::Writer& writer = current_->writer;
  return writer.bytes_written() + writer.closing_bytes() + writer.max_bytes_of(chunk) + metadata_bytes(chunk);
}

/// Upper bound of the records after a chunk: settings, losses, and the end.
std::uint64_t FileSeries::metadata_bytes(const mcap::Chunk& chunk) const {
  constexpr std::uint64_t record_of_losses = 300;
  constexpr std::uint64_t record_of_end = 700;
  const std::uint16_t settings_id = channel_id_of(options_.channels, settings_topic);
  std::uint64_t settings = 0;
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    // The text of a setting is about as long as in the sample.
    if (entry.channel_id == settings_id) settings += 2 * message_at(chunk, entry).data.size();
  }
  return settings + record_of_losses + record_of_end;
}

/// Writes the latched samples from before this file, at its start.
void FileSeries::write_latched(const mcap::Chunk& before) {
  const mcap::Chunk latched = latched_.chunk_at(before.log_times().start_ns);
  if (latched.is_empty()) return;
  try {
    write_chunk(latched);
  } catch (...) {
    count_repeated();
    throw;
  }
  count_repeated();
}

/// Counts everything in the file, and its losses, as repeated.
void FileSeries::count_repeated() {
  repeated_ = current_->writer.statistics().message_count;
  repeated_lost_ = current_->writer.lost_messages();
}

void FileSeries::write_chunk(const mcap::Chunk& chunk) {
  current_->writer.write(chunk);
  current_->part.is_kept = true;
  for (const mcap::Metadata& settings : settings_.on(chunk)) current_->writer.write_metadata(settings);
}

/// Writes the losses so far, so that a truncated file has them.
void FileSeries::write_losses(const TapCounts& counts) {
  const TapCounts last = std::exchange(counts_reported_, counts);
  const TapCounts new_counts = difference(counts, last);
  if (new_counts.lost_queue == 0 && new_counts.lost_dds == 0 && new_counts.events_missing == 0) return;
  const TapCounts own = difference(counts, counts_at_start_);
  current_->writer.write_metadata(
      {"sonopose.losses",
       {{"log_time_ns", std::to_string(current_->writer.statistics().log_times.end_ns)},
        {"lost_queue", std::to_string(own.lost_queue)},
        {"lost_dds", std::to_string(own.lost_dds)},
        {"events_missing", std::to_string(own.events_missing)}}});
}

void FileSeries::count_from(const TapCounts& counts) {
  const threads::Lock lock(mutex_);
  if (current_) return;
  counts_at_start_ = counts;
  counts_reported_ = counts;
}

void FileSeries::finish(const std::string& reason, const TapCounts& counts, const mcap::TextMap& more) {
  const threads::Lock lock(mutex_);
  end_file(reason, counts, more);
}

void FileSeries::end_file(const std::string& reason, const TapCounts& counts, const mcap::TextMap& more) {
  if (!current_) return;
  mcap::Writer& writer = current_->writer;
  const TapCounts own = difference(counts, std::exchange(counts_at_start_, counts));
  counts_reported_ = counts;
  mcap::TextMap end = more;
  end["reason"] = reason;
  const std::uint64_t recorded = writer.statistics().message_count - repeated_;
  const std::uint64_t lost_disk = lost_now() - lost_at_start_;
  // Not own.received: the queue already holds messages of the next file.
  end["received"] = std::to_string(recorded + own.lost_queue + lost_disk);
  end["recorded"] = std::to_string(recorded);
  end["repeated"] = std::to_string(repeated_);
  end["lost_queue"] = std::to_string(own.lost_queue);
  end["lost_disk"] = std::to_string(lost_disk);
  end["lost_dds"] = std::to_string(own.lost_dds);
  end["events_missing"] = std::to_string(own.events_missing);
  std::exception_ptr failure;
  try {
    writer.write_last_metadata({"sonopose.recording_end", end});
  } catch (const files::IoError&) {
    failure = std::current_exception();  // the rest may fit
  }
  try {
    writer.close();
  } catch (const files::IoError&) {
    if (!failure) failure = std::current_exception();
  }
  finished_messages_ += recorded;
  const std::uint64_t bytes = writer.bytes_written();
  finished_bytes_ += bytes;
  lost_ = lost_now();
  lost_at_start_ = lost_;
  current_->part.is_kept = true;
  const recording::PartFile name = current_->name;
  current_.reset();
  name.commit();
  complete_.push_back({name.file(), bytes});
  ++finished_files_;
  if (failure) std::rethrow_exception(failure);
}

void FileSeries::remember(const mcap::Chunk& chunk) {
  const threads::Lock lock(mutex_);
  latched_.on(chunk);
}

void FileSeries::count_lost(std::uint64_t messages) {
  const threads::Lock lock(mutex_);
  lost_ += messages;
}

std::vector<std::filesystem::path> FileSeries::files() const {
  const threads::Lock lock(mutex_);
  std::vector<std::filesystem::path> names;
  for (const RecordedFile& each : complete_) names.push_back(each.file);
  return names;
}

std::size_t FileSeries::removed_files() const {
  const threads::Lock lock(mutex_);
  return removed_files_;
}

std::uint64_t FileSeries::message_count() const {
  const threads::Lock lock(mutex_);
  return finished_messages_ + (current_ ? current_->writer.statistics().message_count - repeated_ : 0);
}

std::uint64_t FileSeries::byte_count() const {
  const threads::Lock lock(mutex_);
  return finished_bytes_ + (current_ ? current_->writer.bytes_written() : 0);
}

std::uint64_t FileSeries::lost_disk() const {
  const threads::Lock lock(mutex_);
  return lost_now();
}

std::uint64_t FileSeries::lost_now() const {
  return lost_ + (current_ ? current_->writer.lost_messages() - repeated_lost_ : 0);
}

}  // namespace sonopose::recorder
