#include "recorder/write_thread.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace sonopose::recorder {
namespace {

/// A chunk is complete at least every second, also where the disk needs half of it.
constexpr std::chrono::milliseconds chunk_period{500};

}  // namespace

WriteThread::WriteThread(Parts parts) : parts_(std::move(parts)) {
  thread_ = std::jthread([this](const std::stop_token& end) { serve(end); });
}

void WriteThread::finish() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

std::exception_ptr WriteThread::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void WriteThread::serve(const std::stop_token& end) {
  mcap::Chunk chunk = parts_.queue.make_chunk();
  bool is_last = false;
  while (!is_last) {
    {
      std::unique_lock lock(mutex_);
      sleep_.wait_for(lock, end, chunk_period, [] { return false; });
    }
    is_last = end.stop_requested();  // before the look at the queue: nothing is queued after it
    parts_.queue.exchange(chunk);
    write(chunk);
  }
}

void WriteThread::write(mcap::Chunk& chunk) {
  if (failure()) {
    parts_.series.count_lost(chunk.message_count());
    return;
  }
  const TriggerCause cause = parts_.trigger.take();
  try {
    if (!parts_.last) {
      parts_.series.write(chunk, parts_.counts());
    } else {
      if (!chunk.is_empty()) parts_.last->add(chunk);
      if (cause != TriggerCause::none) write_last(cause);
    }
  } catch (const std::exception&) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    parts_.failed.wake();
  }
}

void WriteThread::write_last(TriggerCause cause) {
  if (parts_.last->chunks().empty()) {
    logging::warning(fmt::format("triggered by {}, but there is nothing to write", words_of(cause)));
    return;
  }
  const bool is_short = parts_.last->is_short();
  const TapCounts counts = parts_.counts();
  parts_.series.open();
  for (const mcap::Chunk& chunk : parts_.last->chunks()) parts_.series.write(chunk, counts);
  parts_.last->clear();
  parts_.series.finish("trigger", counts,
                       {{"trigger", words_of(cause)}, {"is_short", is_short ? "true" : "false"}});
  logging::info(
      fmt::format("triggered by {}: {}{}", words_of(cause), parts_.series.files().back().string(),
                  is_short ? "; the memory was too small for all of the time (--keep-memory)" : ""));
}

}  // namespace sonopose::recorder
