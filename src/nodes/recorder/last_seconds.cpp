#include "recorder/last_seconds.hpp"

#include <utility>

namespace sonopose::recorder {

std::vector<mcap::Chunk> LastSeconds::drop_until(SteadyTime now) {
  std::vector<mcap::Chunk> dropped;
  while (!chunks_.empty() && chunks_.front().taken.end + keep_ns_ < now) dropped.push_back(take_first());
  return dropped;
}

std::vector<mcap::Chunk> LastSeconds::add(const mcap::Chunk& chunk, const ArrivalSpan& taken,
                                          const TapCounts& counts_before) {
  chunks_.push_back({chunk, taken, counts_before});  // a copy has no more memory than it needs
  bytes_ += bytes_of(chunk);
  auto dropped = drop_until(taken.end);
  while (bytes_ > max_bytes_ && chunks_.size() > 1) {
    short_until_ = chunks_.front().taken.end + keep_ns_;
    dropped.push_back(take_first());
  }
  return dropped;
}

void LastSeconds::clear() {
  chunks_.clear();
  bytes_ = 0;
  short_until_.reset();
}

bool LastSeconds::is_short() const {
  return short_until_ && !chunks_.empty() && chunks_.back().taken.end <= *short_until_;
}

std::size_t LastSeconds::bytes_of(const mcap::Chunk& chunk) {
  return chunk.records().size() + chunk.entries().size() * sizeof(mcap::Chunk::Entry);
}

mcap::Chunk LastSeconds::take_first() {
  mcap::Chunk first = std::move(chunks_.front().chunk);
  chunks_.pop_front();
  bytes_ -= bytes_of(first);
  return first;
}

}  // namespace sonopose::recorder
