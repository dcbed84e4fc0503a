#pragma once
/// \file
/// Queue of messages from the receive threads to the writing thread.

#include "mcap/chunk.hpp"
#include "threads/mutex.hpp"

#include <cstddef>
#include <span>

namespace sonopose::recorder {

/// Receiving threads copy each message once, in the form that it has in the file. The writing thread takes
/// all messages together and returns an empty chunk for the next ones. All memory is allocated at the start.
class ChunkQueue {
public:
  /// `max_bytes`: limit of the waiting records.
  explicit ChunkQueue(std::size_t max_bytes);

  /// Copies a message, from any thread; `head` precedes its data. Returns false if there is no space. Does
  /// not allocate.
  bool add(const mcap::Message& message, std::span<const std::byte> head = {}) noexcept;

  /// Replaces `chunk` by the messages since the last call, and reuses its memory for the next ones.
  void exchange(mcap::Chunk& chunk);

  /// An empty chunk with memory for as many messages.
  [[nodiscard]] mcap::Chunk make_chunk() const;

private:
  std::size_t max_bytes_;
  std::size_t max_messages_;
  threads::Mutex mutex_;
  mcap::Chunk current_ SONOPOSE_GUARDED_BY(mutex_);
};

}  // namespace sonopose::recorder
