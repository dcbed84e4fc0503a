#pragma once
/// \file
/// The last seconds of a stream of messages, in memory.

#include "mcap/chunk.hpp"
#include "recorder/arrival_span.hpp"
#include "recorder/topic_tap.hpp"

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace sonopose::recorder {

/// Chunks of the last seconds, bounded by time and memory.
class LastSeconds {
public:
  struct Kept {
    mcap::Chunk chunk;
    ArrivalSpan taken;
    TapCounts counts_before;  ///< counts before its messages
  };

  /// Keeps chunks of the last `keep_ns`, but at most `max_bytes` of them.
  LastSeconds(TimeNs keep_ns, std::size_t max_bytes) : keep_ns_(keep_ns), max_bytes_(max_bytes) {}

  /// Adds a chunk. Returns the chunks that are dropped for it, the oldest first.
  std::vector<mcap::Chunk> add(const mcap::Chunk& chunk, const ArrivalSpan& taken,
                               const TapCounts& counts_before = {});
  /// Drops the chunks that are too old at that time, and returns them.
  std::vector<mcap::Chunk> drop_until(SteadyTime now);
  /// Drops all.
  void clear();

  [[nodiscard]] const std::deque<Kept>& chunks() const { return chunks_; }
  /// True if the memory was too small for the messages of the last `keep_ns`.
  [[nodiscard]] bool is_short() const;

private:
  static std::size_t bytes_of(const mcap::Chunk& chunk);
  mcap::Chunk take_first();

  TimeNs keep_ns_;
  std::size_t max_bytes_;
  std::deque<Kept> chunks_;
  std::size_t bytes_ = 0;
  std::optional<SteadyTime> short_until_;  ///< time up to which chunks are missing
};

}  // namespace sonopose::recorder
