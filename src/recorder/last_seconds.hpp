#pragma once
/// \file
/// The last seconds of a stream of messages, in memory.

#include "mcap/chunk.hpp"
#include "recorder/taken.hpp"
#include "recorder/topic_tap.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace sonopose::recorder {

class LastSeconds {
public:
  struct Kept {
    mcap::Chunk chunk;
    Taken taken;
    TapCounts counts_before;  ///< what had happened before its messages
  };

  /// Keeps chunks of the last `keep_ns`, and at most `most_bytes` of them.
  LastSeconds(TimeNs keep_ns, std::size_t most_bytes) : keep_ns_(keep_ns), most_bytes_(most_bytes) {}

  /// Returns the chunks that it drops for it, the oldest first.
  std::vector<mcap::Chunk> add(const mcap::Chunk& chunk, const Taken& taken,
                               const TapCounts& counts_before = {});
  /// Drops what is too old at that time.
  std::vector<mcap::Chunk> drop_until(SteadyTime now);
  /// Forgets all.
  void clear();

  [[nodiscard]] const std::deque<Kept>& chunks() const { return chunks_; }
  /// Whether the memory was too small for what came in the last `keep_ns`.
  [[nodiscard]] bool is_short() const;

private:
  static std::size_t bytes_of(const mcap::Chunk& chunk);
  mcap::Chunk take_first();

  TimeNs keep_ns_;
  std::size_t most_bytes_;
  std::deque<Kept> chunks_;
  std::size_t bytes_ = 0;
  std::optional<SteadyTime> short_until_;  ///< chunks of the time before are missing
};

}  // namespace sonopose::recorder
