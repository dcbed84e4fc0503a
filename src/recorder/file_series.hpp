#pragma once
/// \file
/// The files of one recording, one after the other.

#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "recorder/latched_samples.hpp"
#include "recorder/settings_log.hpp"
#include "recorder/taken.hpp"
#include "recorder/topic_tap.hpp"
#include "recording/part_file.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recorder {

/// A channel of every file.
struct ChannelSpec {
  std::string topic;
  std::string message_encoding;
  std::string schema_name;
  std::string schema_encoding;
  std::string schema_data;
  mcap::TextMap metadata = {};
  bool is_latched = false;  ///< late readers receive its latest messages: each file begins with them
};

struct SeriesOptions {
  std::filesystem::path file;
  mcap::WriterOptions writer;
  std::vector<ChannelSpec> channels;  ///< their ids are 1, 2, … in this order
  mcap::TextMap about;                ///< of the recording; each file adds its number
  bool is_numbered = false;           ///< FILE_001, FILE_002, … instead of one file
  std::uint64_t max_size_bytes = 0;   ///< of a file; 0: no limit
  std::int64_t max_duration_ns = 0;   ///< of a file; 0: no limit
};

/// Everything may be called from any thread, and throws files::IoError.
class FileSeries {
public:
  /// Checks that the first file can begin; `open` or `write` creates it.
  explicit FileSeries(SeriesOptions options);
  FileSeries(const FileSeries&) = delete;
  FileSeries& operator=(const FileSeries&) = delete;
  FileSeries(FileSeries&&) = delete;
  FileSeries& operator=(FileSeries&&) = delete;
  ~FileSeries() = default;

  /// Another channel of every file from now on: its id.
  std::uint16_t add_channel(ChannelSpec channel);
  /// Those of imu, fix and heading; 0: not recorded. Called before any thread writes.
  [[nodiscard]] std::array<std::uint16_t, 3> input_channel_ids() const;
  /// The one of the ends of instances; 0: not recorded.
  [[nodiscard]] std::uint16_t ends_channel_id() const;
  /// The topic of a channel.
  [[nodiscard]] std::string topic(std::uint16_t channel_id) const;
  /// Begins a file, if there is none.
  void open();
  /// Writes the messages. If one file would be larger or longer than allowed, another one begins before.
  void write(const mcap::Chunk& chunk, const Taken& taken, const TapCounts& counts);
  /// Remembers the latched samples of messages that are not written: the next file begins with them.
  void remember(const mcap::Chunk& chunk);
  /// Counts messages that are not written after an error.
  void count_lost(std::uint64_t messages);
  /// What was lost up to these counts is not of the next file: it begins with messages from then on.
  void count_from(const TapCounts& counts);
  /// Ends the current file, closes it, and gives it its name. `reason` is written to it.
  void finish(const std::string& reason, const TapCounts& counts, const mcap::TextMap& more = {});

  /// What was written to all files, with those that are still open, but without what files repeat.
  [[nodiscard]] std::uint64_t message_count() const;
  [[nodiscard]] std::uint64_t byte_count() const;
  [[nodiscard]] std::uint64_t lost_disk() const;
  /// The names of the files that are complete.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// What the current file is called until it is complete, or the next one.
  [[nodiscard]] std::filesystem::path part() const;

private:
  /// Removes a part without messages, so that the next recording can begin.
  struct Part {
    explicit Part(std::filesystem::path of) : path(std::move(of)) {}
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    Part(Part&&) = delete;
    Part& operator=(Part&&) = delete;
    ~Part();

    std::filesystem::path path;
    bool is_kept = false;
  };

  /// One that is being written.
  struct File {
    File(const std::filesystem::path& path, const mcap::WriterOptions& options)
        : name(path), sink(name.part()), part(name.part()), writer(sink, options) {}

    recording::PartFile name;
    mcap::FileSink sink;
    Part part;
    mcap::Writer writer;
  };

  // With the mutex held.
  void begin_file();
  void write_head();
  std::uint16_t add_to_file(const ChannelSpec& channel);
  void end_file(const std::string& reason, const TapCounts& counts, const mcap::TextMap& more);
  [[nodiscard]] std::uint64_t lost_now() const;
  [[nodiscard]] std::filesystem::path file_of(std::size_t number) const;
  [[nodiscard]] std::size_t next_number() const;
  void prepare_for(const mcap::Chunk& chunk, const Taken& taken);
  /// Why another file begins before the chunk; null if it fits into this one.
  [[nodiscard]] const char* limit_of(const mcap::Chunk& chunk, const Taken& taken) const;
  [[nodiscard]] std::uint64_t metadata_bytes(const mcap::Chunk& chunk) const;
  void write_latched(const mcap::Chunk& before);
  void count_repeated();
  void write_chunk(const mcap::Chunk& chunk);
  void write_losses(const TapCounts& counts);

  mutable std::mutex mutex_;  // guards all that follows
  SeriesOptions options_;
  std::optional<File> current_;
  TapCounts counts_at_start_;  ///< of the current file
  TapCounts counts_reported_;  ///< in its metadata
  LatchedSamples latched_;
  SettingsLog settings_;
  std::optional<SteadyTime> began_;  ///< the current file, if it has a message
  std::uint64_t repeated_ = 0;       ///< messages at its start that are from before
  std::uint64_t repeated_lost_ = 0;  ///< such messages that the disk lost: they are in a file before
  std::vector<std::filesystem::path> files_;
  std::size_t last_number_ = 0;  ///< of the current file, or of the one before
  std::uint64_t finished_messages_ = 0;
  std::uint64_t finished_bytes_ = 0;
  std::uint64_t lost_ = 0;           ///< by the disk; the current writer counts its own
  std::uint64_t lost_at_start_ = 0;  ///< of the current file
};

}  // namespace sonopose::recorder
