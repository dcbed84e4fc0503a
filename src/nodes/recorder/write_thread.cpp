#include "recorder/write_thread.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "mcap/chunk_messages.hpp"
#include "recorder/raw_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace sonopose::recorder {
namespace {

/// Writing period. A chunk is complete at least every second, even if the disk needs half of it.
constexpr std::chrono::milliseconds chunk_period{500};

}  // namespace

void WriteThread::start() {
  thread_ = std::jthread([this](const std::stop_token& end) { serve(end); });
}

void WriteThread::finish() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

std::exception_ptr WriteThread::failure() const {
  const threads::Lock lock(mutex_);
  return failure_;
}

void WriteThread::serve(const std::stop_token& end) {
  mcap::Chunk chunk = parts_.queue.make_chunk();
  ArrivalSpan taken{.begin = clocks::steady_now(), .end = {}};
  bool is_last = false;
  while (!is_last) {
    {
      threads::Lock lock(mutex_);
      sleep_.wait_for(lock, end, chunk_period, [] { return false; });
    }
    is_last = end.stop_requested();  // before the exchange: nothing is queued after it
    // Take the trigger before the messages, so that they include its cause.
    const TriggerCause cause = parts_.trigger.take();
    parts_.queue.exchange(chunk);
    taken.end = clocks::steady_now();
    make_text_of_ends(chunk);
    parts_.gaps.on(chunk);
    if (is_last) parts_.gaps.finish();
    write(chunk, taken, cause);
    taken.begin = taken.end;
  }
}

void WriteThread::make_text_of_ends(mcap::Chunk& chunk) {
  const std::uint16_t ends_channel_id = parts_.series.ends_channel_id();
  const auto is_end = [ends_channel_id](const auto& entry) { return entry.channel_id == ends_channel_id; };
  if (std::none_of(chunk.entries().begin(), chunk.entries().end(), is_end)) return;
  const mcap::Chunk text = with_ends_as_text(
      chunk, ends_channel_id, [this](std::uint16_t channel_id) { return parts_.series.topic(channel_id); },
      ends_sequence_);
  // Keep the chunk's memory for the queue, which must not allocate.
  chunk.clear();
  for (const auto& entry : text.entries()) chunk.add(message_at(text, entry));
}

void WriteThread::write(const mcap::Chunk& chunk, const ArrivalSpan& taken, TriggerCause cause) {
  if (failure()) {
    parts_.series.count_lost(chunk.message_count());
    return;
  }
  try {
    if (!parts_.last) {
      parts_.series.write(chunk, taken, parts_.counts());
    } else {
      keep(chunk, taken);
      if (cause != TriggerCause::none) write_last(cause);
    }
  } catch (const std::exception&) {
    const threads::Lock lock(mutex_);
    failure_ = std::current_exception();
    parts_.failed.wake();
  }
}

void WriteThread::keep(const mcap::Chunk& chunk, const ArrivalSpan& taken) {
  const TapCounts before = std::exchange(counts_before_, parts_.counts());
  const auto dropped =
      chunk.is_empty() ? parts_.last->drop_until(taken.end) : parts_.last->add(chunk, taken, before);
  for (const mcap::Chunk& old : dropped) parts_.series.remember(old);
}

void WriteThread::write_last(TriggerCause cause) {
  if (parts_.last->chunks().empty()) {
    logging::warning(fmt::format("triggered by {}, but there is nothing to write", text_of(cause)));
    return;
  }
  const bool is_short = parts_.last->is_short();
  const TapCounts counts = parts_.counts();
  write_kept(counts);
  parts_.series.finish("trigger", counts,
                       {{"trigger", text_of(cause)}, {"is_short", is_short ? "true" : "false"}});
  logging::info(
      fmt::format("triggered by {}: {}{}", text_of(cause), parts_.series.files().back().string(),
                  is_short ? "; the memory was too small for all of the time (--keep-memory)" : ""));
}

void WriteThread::write_kept(const TapCounts& counts) {
  parts_.series.count_from(parts_.last->chunks().front().counts_before);
  auto kept = parts_.last->chunks().begin();
  const auto end = parts_.last->chunks().end();
  try {
    for (; kept != end; ++kept) parts_.series.write(kept->chunk, kept->taken, counts);
  } catch (const std::exception&) {
    // The series has counted the chunk that it could not write.
    for (++kept; kept != end; ++kept) parts_.series.count_lost(kept->chunk.message_count());
    parts_.last->clear();
    throw;
  }
  parts_.last->clear();
}

}  // namespace sonopose::recorder
