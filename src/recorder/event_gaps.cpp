#include "recorder/event_gaps.hpp"

#include "recorder/chunk_messages.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <algorithm>
#include <utility>

namespace sonopose::recorder {

void EventNumbers::on(std::uint64_t number) {
  if (number <= highest_) {
    if (received_[index_of(number)]) return;
    received_.set(index_of(number));
    if (highest_ - number >= settled_after) --missing_;
    return;
  }
  while (highest_ < number) {
    ++highest_;
    received_.set(index_of(highest_), highest_ == number);
    if (!received_[index_of(highest_ - settled_after)]) ++missing_;
  }
}

void EventNumbers::finish() {
  constexpr std::uint64_t under_way = 8;
  for (std::uint64_t back = under_way; back < settled_after && back <= highest_; ++back) {
    if (!received_[index_of(highest_ - back)]) ++missing_;
  }
}

void EventGaps::finish() {
  for (auto& [address, beacon] : beacons_) {
    const std::uint64_t known = beacon.latest.missing();
    beacon.latest.finish();
    missing_ += beacon.latest.missing() - known;
  }
}

void EventGaps::on(const mcap::Chunk& chunk) {
  if (std::find(channel_ids_.begin(), channel_ids_.end(), 0) != channel_ids_.end()) return;
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    if (std::find(channel_ids_.begin(), channel_ids_.end(), entry.channel_id) == channel_ids_.end()) continue;
    const mcap::Message message = message_at(chunk, entry);
    const auto address = dds::topics::beacon_of(message.data);
    const auto number = dds::topics::event_sequence_of(message.data);
    if (address && number) on(*address, *number);
  }
}

void EventGaps::on(BeaconAddress address, std::uint64_t number) {
  const auto [found, is_new] = beacons_.try_emplace(address, Beacon{EventNumbers(number)});
  if (is_new) return;
  Beacon& beacon = found->second;
  choose_numbering(beacon, number);
  const std::uint64_t known = beacon.latest.missing();
  beacon.latest.on(number);
  missing_ += beacon.latest.missing() - known;
}

void EventGaps::choose_numbering(Beacon& beacon, std::uint64_t number) {
  if (beacon.latest.contains(number)) return;
  if (beacon.before && beacon.before->contains(number)) {
    missing_ -= std::exchange(beacon.gap_between, 0);
    std::swap(*beacon.before, beacon.latest);
    return;
  }
  const std::uint64_t highest = beacon.latest.highest();
  const bool is_loss = number > highest && number - highest <= longest_gap;
  beacon.gap_between = is_loss ? number - highest - 1 : 0;
  missing_ += beacon.gap_between;
  beacon.before = std::exchange(beacon.latest, EventNumbers(number));
}

}  // namespace sonopose::recorder
