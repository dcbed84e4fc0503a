#include "recorder/last_seconds.hpp"

namespace sonopose::recorder {

void LastSeconds::add(const mcap::Chunk& chunk) {
  chunks_.push_back(chunk);  // a copy has no more memory than it needs
  bytes_ += bytes_of(chunk);
  const std::uint64_t end_ns = chunk.log_times().end_ns;
  while (chunks_.front().log_times().end_ns + keep_ns_ < end_ns) drop_first();
  while (bytes_ > most_bytes_ && chunks_.size() > 1) {
    drop_first();
    is_short_ = true;
  }
}

void LastSeconds::clear() {
  chunks_.clear();
  bytes_ = 0;
  is_short_ = false;
}

std::size_t LastSeconds::bytes_of(const mcap::Chunk& chunk) {
  return chunk.records().size() + chunk.entries().size() * sizeof(mcap::Chunk::Entry);
}

void LastSeconds::drop_first() {
  bytes_ -= bytes_of(chunks_.front());
  chunks_.pop_front();
}

}  // namespace sonopose::recorder
