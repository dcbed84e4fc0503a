#include "mcap/append.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace sonopose::mcap {

namespace {

/// Returns the id of an equal definition, which is added if there is none.
template <class Definition>
std::uint16_t id_in(std::map<std::uint16_t, Definition>& known, Definition definition,
                    const RecordFile& file) {
  const auto equal = std::ranges::find_if(known, [&](auto& entry) {
    definition.id = entry.first;
    return entry.second == definition;
  });
  if (equal != known.end()) return equal->first;
  constexpr std::uint16_t max_id = std::numeric_limits<std::uint16_t>::max();
  const std::uint16_t last = known.empty() ? 0 : known.rbegin()->first;
  if (last == max_id) file.place(0).fail("has more schemas or channels than a recording can have");
  definition.id = static_cast<std::uint16_t>(last + 1);
  known.emplace(definition.id, std::move(definition));
  return static_cast<std::uint16_t>(last + 1);
}

}  // namespace

std::map<std::uint16_t, std::uint16_t> append(Contents& recording, Contents next, const RecordFile& file,
                                              std::size_t number) {
  std::map<std::uint16_t, std::uint16_t> schema_ids{{no_schema, no_schema}};
  for (auto& [id, schema] : next.schemas) {
    schema_ids[id] = id_in(recording.schemas, std::move(schema), file);
  }
  std::map<std::uint16_t, std::uint16_t> channel_ids;
  for (auto& [id, channel] : next.channels) {
    channel.schema_id = schema_ids[channel.schema_id];  // a missing schema is none
    channel_ids[id] = id_in(recording.channels, std::move(channel), file);
  }
  for (Block& block : next.blocks) {
    block.file = number;
    for (std::uint16_t& id : block.channels) id = channel_ids.at(id);
    std::ranges::sort(block.channels);
    recording.blocks.push_back(std::move(block));
  }
  const auto add_extents = [number](std::vector<Extent>& to, std::vector<Extent>& from) {
    for (Extent& record : from) record.file = number;
    std::ranges::move(from, std::back_inserter(to));
  };
  add_extents(recording.metadata, next.metadata);
  add_extents(recording.attachments, next.attachments);
  for (const std::string& text : next.unreadable_blocks) recording.unreadable_blocks.push_back(text);
  for (const std::string& text : next.damages) recording.damages.push_back(text);
  Statistics& sum = recording.statistics;
  sum.message_count += next.statistics.message_count;
  sum.chunk_count += next.statistics.chunk_count;
  sum.log_times.include(next.statistics.log_times);
  for (const auto& [id, count] : next.statistics.channel_message_counts) {
    sum.channel_message_counts[channel_ids.at(id)] += count;
  }
  sum.schema_count = static_cast<std::uint16_t>(recording.schemas.size());
  sum.channel_count = static_cast<std::uint32_t>(recording.channels.size());
  sum.metadata_count = static_cast<std::uint32_t>(recording.metadata.size());
  sum.attachment_count = static_cast<std::uint32_t>(recording.attachments.size());
  recording.lost_messages += next.lost_messages;
  recording.has_uncounted_loss = recording.has_uncounted_loss || next.has_uncounted_loss;
  recording.is_indexed = recording.is_indexed && next.is_indexed;
  return channel_ids;
}

}  // namespace sonopose::mcap
