#pragma once
/// \file
/// The last seconds of a stream of messages, in memory.

#include "mcap/chunk.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace sonopose::recorder {

class LastSeconds {
public:
  /// Keeps chunks of the last `keep_ns` by their log time, and at most `most_bytes` of them.
  LastSeconds(std::int64_t keep_ns, std::size_t most_bytes)
      : keep_ns_(static_cast<std::uint64_t>(keep_ns)), most_bytes_(most_bytes) {}

  /// Returns the chunks that it drops for it, the oldest first.
  std::vector<mcap::Chunk> add(const mcap::Chunk& chunk);
  /// Forgets all.
  void clear();

  [[nodiscard]] const std::deque<mcap::Chunk>& chunks() const { return chunks_; }
  /// Whether the memory was too small for the time, since the last `clear`.
  [[nodiscard]] bool is_short() const { return is_short_; }

private:
  static std::size_t bytes_of(const mcap::Chunk& chunk);
  mcap::Chunk take_first();

  std::uint64_t keep_ns_;
  std::size_t most_bytes_;
  std::deque<mcap::Chunk> chunks_;
  std::size_t bytes_ = 0;
  bool is_short_ = false;
};

}  // namespace sonopose::recorder
