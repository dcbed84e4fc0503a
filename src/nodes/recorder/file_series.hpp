#pragma once
/// \file
/// Consecutive files of one recording.

#include "bus_log/latched_samples.hpp"
#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "recorder/arrival_span.hpp"
#include "recorder/earlier_files.hpp"
#include "recorder/settings_log.hpp"
#include "recorder/topic_tap.hpp"
#include "recording/part_file.hpp"
#include "threads/mutex.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
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
  bool is_latched = false;  ///< late readers receive its latest messages, so each file starts with them
};

struct SeriesOptions {
  std::filesystem::path file;
  mcap::WriterOptions writer;
  std::vector<ChannelSpec> channels;      ///< their ids are 1, 2, …, in this order
  mcap::TextMap about;                    ///< metadata of the recording; each file adds its number
  bool is_numbered = false;               ///< FILE_001, FILE_002, … instead of one file
  std::uint64_t max_size_bytes = 0;       ///< limit of a file; 0: none
  std::int64_t max_duration_ns = 0;       ///< limit of a file; 0: none
  std::size_t max_files = 0;              ///< limit, beyond which the oldest files are removed; 0: none
  std::uint64_t max_total_bytes = 0;      ///< limit of all files, of which the oldest are removed; 0: none
  std::deque<RecordedFile> earlier = {};  ///< files of earlier recordings that the limits include
};

/// The files of a recording. All members may be called from any thread, and throw files::IoError.
class FileSeries {
public:
  /// Checks that the first file can be created, which `open` or `write` does.
  explicit FileSeries(SeriesOptions options);
  FileSeries(const FileSeries&) = delete;
  FileSeries& operator=(const FileSeries&) = delete;
  ~FileSeries() = default;

  /// Adds a channel to the current and all later files. Returns its id.
  std::uint16_t add_channel(ChannelSpec channel);
  /// Channels of imu, fix, heading and twist; 0: not recorded. Call it before any thread writes.
  [[nodiscard]] std::array<std::uint16_t, 4> input_channel_ids() const;
  /// Channel of the ends of instances; 0: not recorded.
  [[nodiscard]] std::uint16_t ends_channel_id() const;
  /// Topic of a channel.
  [[nodiscard]] std::string topic(std::uint16_t channel_id) const;
  /// Creates a file, if none is open.
  void open();
  /// Writes the messages. Starts another file first if one would be larger or longer than allowed.
  void write(const mcap::Chunk& chunk, const ArrivalSpan& taken, const TapCounts& counts);
  /// Remembers latched samples among messages that are not written: the next file starts with them.
  void remember(const mcap::Chunk& chunk);
  /// Counts messages that are not written after an error.
  void count_lost(std::uint64_t messages);
  /// Excludes losses up to these counts from the next file: it starts with later messages.
  void count_from(const TapCounts& counts);
  /// Ends and closes the current file, and gives it its name. `reason` is written to it.
  void finish(const std::string& reason, const TapCounts& counts, const mcap::TextMap& more = {});

  /// Number of messages in all files of this recording, including open ones, without those that files repeat.
  [[nodiscard]] std::uint64_t message_count() const;
  [[nodiscard]] std::uint64_t byte_count() const;
  [[nodiscard]] std::uint64_t lost_disk() const;
  /// Names of the complete files, without those that were removed.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  [[nodiscard]] std::size_t removed_files() const;
  /// Temporary name of the current file, or of the next one.
  [[nodiscard]] std::filesystem::path part() const;

private:
  /// Removes a part without messages, so that the next recording can start.
  struct Part {
    explicit Part(std::filesystem::path of) : path(std::move(of)) {}
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    ~Part();

    std::filesystem::path path;
    bool is_kept = false;
  };

  /// A file that is being written.
  struct File {
    File(const std::filesystem::path& path, const mcap::WriterOptions& options)
        : name(path), sink(name.part()), part(name.part()), writer(sink, options) {}

    recording::PartFile name;
    mcap::FileSink sink;
    Part part;
    mcap::Writer writer;
  };

  void begin_file() SONOPOSE_REQUIRES(mutex_);
  void write_head() SONOPOSE_REQUIRES(mutex_);
  std::uint16_t add_to_file(const ChannelSpec& channel) SONOPOSE_REQUIRES(mutex_);
  void end_file(const std::string& reason, const TapCounts& counts, const mcap::TextMap& more)
      SONOPOSE_REQUIRES(mutex_);
  [[nodiscard]] std::uint64_t lost_now() const SONOPOSE_REQUIRES(mutex_);
  [[nodiscard]] std::filesystem::path file_of(std::size_t number) const SONOPOSE_REQUIRES(mutex_);
  [[nodiscard]] std::size_t next_number() const SONOPOSE_REQUIRES(mutex_);
  void prepare_for(const mcap::Chunk& chunk, const ArrivalSpan& taken) SONOPOSE_REQUIRES(mutex_);
  /// Upper bound of the current file's size if the chunk is its last one.
  [[nodiscard]] std::uint64_t bytes_with(const mcap::Chunk& chunk) const SONOPOSE_REQUIRES(mutex_);
  /// Removes the oldest files that exceed the limits, together with the current one of that size.
  void remove_old(std::uint64_t current_bytes) SONOPOSE_REQUIRES(mutex_);
  /// Limit that requires another file before the chunk; null if the chunk fits into this one.
  [[nodiscard]] const char* limit_of(const mcap::Chunk& chunk, const ArrivalSpan& taken) const
      SONOPOSE_REQUIRES(mutex_);
  [[nodiscard]] std::uint64_t metadata_bytes(const mcap::Chunk& chunk) const SONOPOSE_REQUIRES(mutex_);
  void write_latched(const mcap::Chunk& before) SONOPOSE_REQUIRES(mutex_);
  void count_repeated() SONOPOSE_REQUIRES(mutex_);
  void write_chunk(const mcap::Chunk& chunk) SONOPOSE_REQUIRES(mutex_);
  void write_losses(const TapCounts& counts) SONOPOSE_REQUIRES(mutex_);

  mutable threads::Mutex mutex_;
  SeriesOptions options_ SONOPOSE_GUARDED_BY(mutex_);
  std::optional<File> current_ SONOPOSE_GUARDED_BY(mutex_);
  TapCounts counts_at_start_ SONOPOSE_GUARDED_BY(mutex_);  ///< counts at the start of the current file
  TapCounts counts_reported_ SONOPOSE_GUARDED_BY(mutex_);  ///< counts last written to the current file
  bus_log::LatchedSamples latched_ SONOPOSE_GUARDED_BY(mutex_);
  SettingsLog settings_ SONOPOSE_GUARDED_BY(mutex_);
  /// Start of the current file, if it has a message.
  std::optional<SteadyTime> began_ SONOPOSE_GUARDED_BY(mutex_);
  /// Earlier messages that the current file repeats.
  std::uint64_t repeated_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  /// Repeated messages that the disk lost: an earlier file has them.
  std::uint64_t repeated_lost_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::deque<RecordedFile> complete_ SONOPOSE_GUARDED_BY(mutex_);  ///< files that were not removed
  std::size_t finished_files_ SONOPOSE_GUARDED_BY(mutex_) = 0;     ///< including removed ones
  std::size_t removed_files_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  /// Number of the current file, or of the previous one.
  std::size_t last_number_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::uint64_t finished_messages_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::uint64_t finished_bytes_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  /// Lost by the disk; the current writer counts its own.
  std::uint64_t lost_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::uint64_t lost_at_start_ SONOPOSE_GUARDED_BY(mutex_) = 0;  ///< value at the start of the current file
};

}  // namespace sonopose::recorder
