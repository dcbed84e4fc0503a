#pragma once
/// \file
/// The thread that writes the messages of the queue.

#include "process/stop_signal.hpp"
#include "recorder/chunk_queue.hpp"
#include "recorder/event_gaps.hpp"
#include "recorder/file_series.hpp"
#include "recorder/last_seconds.hpp"
#include "recorder/trigger.hpp"
#include "threads/mutex.hpp"

#include <condition_variable>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

namespace sonopose::recorder {

/// Takes the messages of the queue and writes them, or the last seconds of them at a trigger.
class WriteThread {
public:
  /// Its collaborators; the references must outlive it.
  struct Parts {
    ChunkQueue& queue;
    FileSeries& series;
    EventGaps& gaps;
    Trigger& trigger;
    std::function<TapCounts()> counts;  ///< counts of all topics so far
    std::optional<LastSeconds> last;    ///< if set, written only after a trigger
    process::Wakeup& failed;            ///< woken if the disk fails
  };

  explicit WriteThread(Parts parts) : parts_(std::move(parts)) {}
  WriteThread(const WriteThread&) = delete;
  WriteThread& operator=(const WriteThread&) = delete;
  ~WriteThread() = default;

  /// Starts writing.
  void start();
  /// Writes the rest of the queue, and ends the thread. Nothing may be queued afterwards.
  void finish();

  /// First error of the disk, after which nothing is written; null without one. From any thread.
  [[nodiscard]] std::exception_ptr failure() const;

private:
  void serve(const std::stop_token& end);
  void make_text_of_ends(mcap::Chunk& chunk);
  void write(const mcap::Chunk& chunk, const ArrivalSpan& taken, TriggerCause cause);
  void keep(const mcap::Chunk& chunk, const ArrivalSpan& taken);
  void write_last(TriggerCause cause);
  void write_kept(const TapCounts& counts);

  Parts parts_;
  std::uint32_t ends_sequence_ = 0;
  TapCounts counts_before_;  ///< counts at the previous exchange
  mutable threads::Mutex mutex_;
  std::condition_variable_any sleep_;
  std::exception_ptr failure_ SONOPOSE_GUARDED_BY(mutex_);
  std::jthread thread_;  ///< last, so that it ends first
};

}  // namespace sonopose::recorder
