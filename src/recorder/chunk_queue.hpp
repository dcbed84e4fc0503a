#pragma once
/// \file
/// Messages on their way from the receiving threads to the thread that writes.

#include "mcap/chunk.hpp"

#include <cstddef>
#include <mutex>
#include <span>

namespace sonopose::recorder {

/// A receiving thread copies each message once, into the form that it has in the file. The writing thread
/// takes them all at once and gives an empty chunk for the next ones. The memory is allocated at the start.
class ChunkQueue {
public:
  /// `most_bytes` of records wait at most.
  explicit ChunkQueue(std::size_t most_bytes);

  /// Copies a message, from any thread; `head` comes before its data. False if there is no space. Does not
  /// allocate.
  bool add(const mcap::Message& message, std::span<const std::byte> head = {}) noexcept;

  /// Replaces `chunk` by the messages since the last call, and keeps its memory for the next ones.
  void exchange(mcap::Chunk& chunk);

  /// An empty chunk with the memory for as many messages.
  [[nodiscard]] mcap::Chunk make_chunk() const;

private:
  std::size_t most_bytes_;
  std::size_t most_messages_;
  std::mutex mutex_;
  mcap::Chunk current_;
};

}  // namespace sonopose::recorder
