#include "recorder/chunk_queue.hpp"

#include <utility>

namespace sonopose::recorder {
namespace {

/// Lower bound of a message's size. The smallest message, a reset command, has twice as many bytes.
constexpr std::size_t min_message_bytes = mcap::Chunk::bytes_of(0);

}  // namespace

ChunkQueue::ChunkQueue(std::size_t max_bytes)
    : max_bytes_(max_bytes), max_messages_(max_bytes / min_message_bytes), current_(make_chunk()) {}

mcap::Chunk ChunkQueue::make_chunk() const {
  return mcap::Chunk(max_bytes_, max_messages_);
}

bool ChunkQueue::add(const mcap::Message& message, std::span<const std::byte> head) noexcept {
  const threads::Lock lock(mutex_);
  const std::size_t bytes = mcap::Chunk::bytes_of(head.size() + message.data.size());
  if (current_.records().size() + bytes > max_bytes_) return false;
  current_.add(message, head);
  return true;
}

void ChunkQueue::exchange(mcap::Chunk& chunk) {
  chunk.clear();
  const threads::Lock lock(mutex_);
  std::swap(current_, chunk);
}

}  // namespace sonopose::recorder
