#include "recorder/event_gaps.hpp"

#include "mcap/chunk_messages.hpp"
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
  for (std::uint64_t back = under_way; back < settled_after && back <= highest_; ++back) {
    if (!received_[index_of(highest_ - back)]) ++missing_;
  }
}

void EventGaps::finish() {
  for (auto& [address, beacon] : beacons_) {
    finish(beacon.latest);
    if (beacon.before) finish(*beacon.before);
  }
}

void EventGaps::finish(EventNumbers& numbers) {
  const std::uint64_t known = numbers.missing();
  numbers.finish();
  missing_ += numbers.missing() - known;
}

void EventGaps::on(const mcap::Chunk& chunk) {
  if (std::find(channel_ids_.begin(), channel_ids_.end(), 0) != channel_ids_.end()) return;
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    if (std::find(channel_ids_.begin(), channel_ids_.end(), entry.channel_id) == channel_ids_.end()) continue;
    const mcap::Message message = message_at(chunk, entry);
    const auto address = dds::topics::beacon_of(message.data);
    const auto number = dds::topics::event_sequence_of(message.data);
    if (address && number && *number != unnumbered) on(*address, *number);
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

/// True if the numbering restarts, as the fusion's collator judges it: consecutive numbers that came before,
/// without a new one between them. A restarted bridge counts from the beginning.
bool EventGaps::numbering_restarted(Beacon& beacon, std::uint64_t number) {
  constexpr unsigned min_repeated = 4;
  if (!beacon.latest.has(number)) {
    beacon.repeated_count = 0;
    return false;
  }
  beacon.repeated_count = number == beacon.repeated + 1 ? beacon.repeated_count + 1 : 1;
  beacon.repeated = number;
  if (beacon.repeated_count < min_repeated) return false;
  beacon.repeated_count = 0;
  return true;
}

void EventGaps::begin_numbering(Beacon& beacon, std::uint64_t first) {
  if (beacon.before) finish(*beacon.before);
  beacon.before = std::exchange(beacon.latest, EventNumbers(first));
  beacon.gap_between = 0;
}

void EventGaps::choose_numbering(Beacon& beacon, std::uint64_t number) {
  if (beacon.latest.contains(number)) {
    if (numbering_restarted(beacon, number)) begin_numbering(beacon, number);
    return;
  }
  if (beacon.before && beacon.before->contains(number)) {
    missing_ -= std::exchange(beacon.gap_between, 0);
    std::swap(*beacon.before, beacon.latest);
    return;
  }
  const std::uint64_t highest = beacon.latest.highest();
  const bool is_loss = number > highest && number - highest <= max_gap;
  begin_numbering(beacon, number);
  beacon.gap_between = is_loss ? number - highest - 1 : 0;
  missing_ += beacon.gap_between;
}

}  // namespace sonopose::recorder
