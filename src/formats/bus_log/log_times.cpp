#include "bus_log/log_times.hpp"

#include "logging/log.hpp"
#include "mcap/record_file.hpp"
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace sonopose::bus_log {
namespace {

constexpr double log_ns_per_s = 1e9;
constexpr std::uint64_t min_step_ns = 1'000'000'000;
constexpr std::uint64_t min_gap_ns = 5'000'000'000;

/// The largest step back of a channel's log times in a block; 0 for a damaged block, which is named when it
/// is played.
std::uint64_t step_back_within(const mcap::RecordFile& file, const mcap::Block& block) {
  if (block.log_times.end_ns - block.log_times.start_ns <= min_step_ns) return 0;
  std::map<std::uint16_t, std::uint64_t> latest_ns;  // by channel
  std::uint64_t step_ns = 0;
  try {
    for (const mcap::LoadedBlock::Item& item : file.load(block).messages) {
      std::uint64_t& latest = latest_ns[item.channel_id];
      step_ns = std::max(step_ns, latest - std::min(latest, item.log_time_ns));
      latest = std::max(latest, item.log_time_ns);
    }
  } catch (const mcap::FormatError&) {
    return 0;
  }
  return step_ns;
}

/// Returns true if a block is so long that it may have a gap.
bool may_have_gap(const mcap::Block& block) {
  return !block.log_times.is_empty() && block.log_times.end_ns - block.log_times.start_ns >= min_gap_ns;
}

/// Appends the times of the messages of a block.
void append_times(const mcap::RecordFile& file, const mcap::Block& block,
                  std::vector<mcap::TimeSpan>& times) {
  try {
    for (const mcap::LoadedBlock::Item& item : file.load(block).messages) {
      times.push_back({item.log_time_ns, item.log_time_ns});
    }
  } catch (const mcap::FormatError&) {
    times.push_back(block.log_times);  // damaged, which is named when it is read
  }
}

}  // namespace

std::optional<std::string> step_back_in(const mcap::Reader& reader) {
  std::map<std::pair<std::size_t, std::uint16_t>, std::uint64_t> latest_starts_ns;  // by file and channel
  const std::vector<mcap::Block>& blocks = reader.contents().blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const mcap::Block& block = blocks[i];
    const mcap::RecordFile& file = reader.file(block.file);
    std::uint64_t step_ns = 0;
    for (const std::uint16_t channel : block.channels) {
      std::uint64_t& latest_ns = latest_starts_ns[{block.file, channel}];
      step_ns = std::max(step_ns, latest_ns - std::min(latest_ns, block.log_times.end_ns));
      latest_ns = std::max(latest_ns, block.log_times.start_ns);
    }
    // The blocks before and after show a step within a chunk.
    const bool has_neighbours = i > 0 && blocks[i - 1].file == block.file && i + 1 < blocks.size() &&
                                blocks[i + 1].file == block.file;
    const bool may_hide_step = block.kind == mcap::Block::Kind::plain || !has_neighbours;
    if (step_ns <= min_step_ns && may_hide_step) step_ns = step_back_within(file, block);
    if (step_ns <= min_step_ns) continue;
    return fmt::format("{}: the log times go back by {}: the host's clock was set", file.name(),
                       text::duration_text(static_cast<double>(step_ns) / log_ns_per_s));
  }
  return std::nullopt;
}

std::optional<std::string> longest_gap_in(const mcap::Reader& reader) {
  std::vector<mcap::TimeSpan> times;
  const std::vector<mcap::Block>& blocks = reader.contents().blocks;
  // Of a large recording of few bytes a second nearly every block would be read.
  constexpr std::ptrdiff_t max_read = 64;
  const bool reads_blocks = std::ranges::count_if(blocks, may_have_gap) <= max_read;
  for (const mcap::Block& block : blocks) {
    if (reads_blocks && may_have_gap(block)) {
      append_times(reader.file(block.file), block, times);
    } else if (!block.log_times.is_empty()) {
      times.push_back(block.log_times);
    }
  }
  std::ranges::sort(times, {}, &mcap::TimeSpan::start_ns);
  std::uint64_t longest_ns = 0;
  std::uint64_t after_ns = 0;
  std::uint64_t reached_ns = times.empty() ? 0 : times.front().start_ns;
  for (const mcap::TimeSpan& span : times) {
    if (span.start_ns > reached_ns && span.start_ns - reached_ns > longest_ns) {
      longest_ns = span.start_ns - reached_ns;
      after_ns = reached_ns - times.front().start_ns;
    }
    reached_ns = std::max(reached_ns, span.end_ns);
  }
  if (longest_ns < min_gap_ns) return std::nullopt;
  return fmt::format("no messages for {} after {:.3f} s",
                     text::duration_text(static_cast<double>(longest_ns) / log_ns_per_s),
                     static_cast<double>(after_ns) / log_ns_per_s);
}

void warn_of_times(const mcap::Reader& reader) {
  if (const auto gap = longest_gap_in(reader)) logging::warning(reader.name() + ": " + *gap);
  if (const auto step = step_back_in(reader)) logging::warning(*step);
}

}  // namespace sonopose::bus_log
