#include "player/gaps.hpp"

#include "logging/log.hpp"
#include "mcap/record_file.hpp"
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sonopose::player {
namespace {

constexpr double ns_per_s = 1e9;
constexpr std::uint64_t min_step_ns = 1'000'000'000;

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

}  // namespace

Gaps::Gaps(std::optional<double> max_gap_s, double rate, std::uint64_t begin_ns)
    : max_gap_s_(max_gap_s), rate_(rate), begin_ns_(begin_ns) {
  if (max_gap_s && (!std::isfinite(*max_gap_s) || *max_gap_s < 0.0)) {
    throw std::invalid_argument(fmt::format("max_gap_s = {}: must be 0 or greater", *max_gap_s));
  }
}

std::uint64_t Gaps::advance_to(std::uint64_t log_time_ns) {
  const std::uint64_t gap_ns = log_time_ns - std::min(log_time_ns, last_ns_);
  const double gap_s = static_cast<double>(gap_ns) / ns_per_s;
  const bool is_shortened = max_gap_s_ && gap_s > *max_gap_s_;
  log(gap_s, is_shortened);
  last_ns_ = std::max(last_ns_, log_time_ns);
  if (!is_shortened) return 0;
  const std::uint64_t left_out_ns = gap_ns - static_cast<std::uint64_t>(*max_gap_s_ * ns_per_s);
  ++shortened_;
  left_out_s_ += static_cast<double>(left_out_ns) / ns_per_s;
  return left_out_ns;
}

void Gaps::log(double gap_s, bool is_shortened) {
  constexpr double min_logged_wait_s = 5;
  constexpr int max_logged = 20;
  const bool is_waited_for = rate_ > 0.0 && gap_s / rate_ >= min_logged_wait_s;
  if (!is_waited_for || logged_ > max_logged) return;
  if (++logged_ > max_logged) {
    logging::warning("further gaps are not named");
    return;
  }
  const double after_s = static_cast<double>(last_ns_ - begin_ns_) / ns_per_s;
  logging::warning(fmt::format(
      "no messages for {} after {:.3f} s{}", text::duration_text(gap_s), after_s,
      is_shortened ? fmt::format(", shortened to {} s", *max_gap_s_) : "; --max-gap S shortens such gaps"));
}

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
                       text::duration_text(static_cast<double>(step_ns) / ns_per_s));
  }
  return std::nullopt;
}

}  // namespace sonopose::player
