#pragma once
/// \file
/// Path from the readers of topics to the files of one recording.

#include "recorder/chunk_queue.hpp"
#include "recorder/event_gaps.hpp"
#include "recorder/file_series.hpp"
#include "recorder/topic_tap.hpp"
#include "recorder/write_thread.hpp"
#include "threads/mutex.hpp"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recorder {

/// Queues the samples of the recorded topics, and writes them to files on its own thread.
class Pipeline {
public:
  struct Settings {
    SeriesOptions series;
    std::size_t queue_bytes = 0;
    std::uint16_t ends_channel_id = 0;  ///< channel of the ends of instances; 0: not recorded
    std::optional<LastSeconds> last;    ///< if set, nothing is written before a trigger
  };

  /// Checks that the first file can be created. The references must outlive it. Throws files::IoError.
  Pipeline(Settings settings, Trigger& trigger, process::Wakeup& failed);

  /// Records a topic on the channel with that id. Its reader is `make_reader(listener)`, whose exceptions
  /// pass.
  using MakeReader = std::function<dds::SerializedReader(dds::sub::DataReaderListener<dds::Serialized>*)>;
  void record(TapTopic topic, std::uint16_t channel_id, const MakeReader& make_reader);

  /// Adds a channel that was unknown at the start. Returns its id.
  std::uint16_t add_channel(ChannelSpec channel) { return series_.add_channel(std::move(channel)); }

  /// Creates the first file, if everything is written immediately. Throws files::IoError.
  void open();
  /// Starts writing the messages of the queue.
  void start() { writing_.start(); }

  /// Totals of all topics. From any thread.
  [[nodiscard]] TapCounts counts() const;
  /// Received samples by topic. Ends of instances are those of a topic of their own, as in the file.
  [[nodiscard]] std::map<std::string, std::uint64_t> received() const;
  /// Address of a beacon that was left out while none was recorded.
  [[nodiscard]] std::optional<BeaconAddress> only_left_out() const;
  /// Number of writers that do not match their reader.
  [[nodiscard]] std::uint64_t incompatible() const;
  [[nodiscard]] const FileSeries& series() const { return series_; }
  /// First error of the disk; null without one.
  [[nodiscard]] std::exception_ptr failure() const { return writing_.failure(); }

  /// Ends the recording, with these metadata. `failure`: cause of the end, or null. Returns the first error.
  std::exception_ptr finish(const mcap::TextMap& more, std::exception_ptr failure = nullptr);

private:
  bool keeps_last_;
  ChunkQueue queue_;
  FileSeries series_;
  EventGaps gaps_;  ///< used by the writing thread
  std::uint16_t ends_channel_id_;
  mutable threads::Mutex mutex_;
  std::vector<std::unique_ptr<TopicTap>> taps_ SONOPOSE_GUARDED_BY(mutex_);
  WriteThread writing_;  ///< last, so that it ends first
};

}  // namespace sonopose::recorder
