#pragma once
/// \file
/// Writes files on its own thread, so that a slow or full disk does not delay publication.

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace sonopose::publication {

/// Behaviour if the disk is slower than the source.
enum class FullQueuePolicy : std::uint8_t {
  lose,  ///< loses and counts the item: for live data
  wait   ///< waits for space: for data that can wait
};

/// A bounded queue from one thread to the writing thread, without locks. The first error of `write` ends the
/// writing and is logged. Lost items are counted and logged.
template <class Item>
class BackgroundWriter {
public:
  using Write = std::function<void(std::span<const Item>)>;

  /// Words for messages, such as "the recording" and "sample": the recording lacks 2 samples.
  struct Words {
    std::string name;
    std::string item;
  };

  /// Longest time that a stalled disk may delay the end.
  static constexpr TimeNs max_delay_ns = 1'000'000'000;

  /// `write` takes items in order and throws if it cannot write them. It must own what it uses: a stalled
  /// disk may block it beyond the life of this object, until the process ends.
  BackgroundWriter(Words words, std::size_t capacity, FullQueuePolicy when_full, Write write)
      : when_full_(when_full),
        queue_(std::make_shared<Queue>(std::move(words), capacity, std::move(write))),
        thread_([queue = queue_](const std::stop_token& end) { queue->serve(end); }) {}
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;
  /// Ends like `finish`, without a report.
  ~BackgroundWriter() { end(); }

  /// Ends the waits for space `max_delay_ns` after the stop. `stop` must outlive this object.
  void obey(const process::StopSignal& stop) { stop_ = &stop; }

  /// Takes all items, at most `capacity`, or loses all. Does not allocate. One thread only.
  void push(std::span<const Item> items) {
    while (when_full_ == FullQueuePolicy::wait && !queue_->can_take(items.size()) && may_wait()) {
      std::this_thread::sleep_for(wait_period);
    }
    queue_->push(items);
  }

  /// Waits until everything has been written; nothing may be pushed afterwards. Gives up after `max_delay_ns`
  /// if the disk is too slow for live data, or after a stop. Throws files::IoError if items were lost.
  void finish() {
    if (!thread_.joinable()) return;
    end();
    if (lost() > 0) throw files::IoError(queue_->lost_words());
  }

  /// Number of items that were not written, because of an error or a full queue. From any thread.
  [[nodiscard]] std::uint64_t lost() const { return queue_->lost; }

private:
  static constexpr std::chrono::milliseconds wait_period{1};
  static constexpr std::chrono::milliseconds write_period{20};
  static constexpr int rounds_per_report = 50;
  static constexpr std::size_t max_at_once = 4096;  ///< in progress when this gives up

  /// State shared by both threads.
  struct Queue {
    Queue(Words the_words, std::size_t capacity, Write the_write)
        : words(std::move(the_words)), write(std::move(the_write)), ring(capacity) {}

    [[nodiscard]] bool can_take(std::size_t count) const {
      const std::uint64_t used =
          pushed.load(std::memory_order_relaxed) - written.load(std::memory_order_acquire);
      return failed || ring.size() - used >= count;
    }

    void push(std::span<const Item> items) {
      if (failed || !can_take(items.size())) {
        lost += items.size();
        return;
      }
      const std::uint64_t end = pushed.load(std::memory_order_relaxed);
      for (std::size_t i = 0; i < items.size(); ++i) ring[(end + i) % ring.size()] = items[i];
      pushed.store(end + items.size(), std::memory_order_release);
    }

    void serve(const std::stop_token& end) {
      bool is_last = false;
      for (int round = 1; !is_last && !abandoned; ++round) {
        is_last = end.stop_requested();  // before the queue is read: nothing is pushed after it
        write_all();
        if (!failed && !abandoned && round % rounds_per_report == 0) report_lost();
        if (!is_last) std::this_thread::sleep_for(write_period);
      }
      ended = true;
    }

    void write_all() {
      const std::uint64_t end = pushed.load(std::memory_order_acquire);
      for (std::uint64_t begin = written.load(std::memory_order_relaxed); begin != end && !abandoned;) {
        const std::size_t first = begin % ring.size();
        const auto count = std::min<std::uint64_t>({end - begin, ring.size() - first, max_at_once});
        write_some(std::span(ring).subspan(first, count));
        begin += count;
        written.store(begin, std::memory_order_release);
      }
    }

    void write_some(std::span<const Item> items) {
      if (!failed) {
        try {
          write(items);
          return;
        } catch (const std::exception& error) {
          if (abandoned) return;
          failed = true;
          logging::error(fmt::format("{} has ended: {}; publishing continues", words.name, error.what()));
        }
      }
      lost += items.size();
    }

    void report_lost() {
      const std::uint64_t now_lost = lost;
      if (std::exchange(reported, now_lost) == now_lost) return;
      logging::warning(lost_words());
    }

    [[nodiscard]] std::string lost_words() const {
      return fmt::format("{} lacks {}: the disk is too slow or full", words.name,
                         text::count_text(lost, words.item));
    }

    Words words;
    Write write;
    std::vector<Item> ring;
    std::atomic<std::uint64_t> pushed = 0;   ///< since the start; modulo the capacity: place in the ring
    std::atomic<std::uint64_t> written = 0;  ///< since the start, including lost ones
    std::atomic<std::uint64_t> lost = 0;
    std::uint64_t reported = 0;  ///< reported part of the lost ones
    std::atomic<bool> failed = false;
    std::atomic<bool> abandoned = false;
    std::atomic<bool> ended = false;
  };

  [[nodiscard]] bool is_stopped() const { return stop_ != nullptr && stop_->requested(); }

  /// True if a push may wait; after the stop for a limited time only, since the disk may have stalled.
  [[nodiscard]] bool may_wait() {
    if (!is_stopped()) return true;
    const SteadyTime now = clocks::steady_now();
    if (!stopped_at_) stopped_at_ = now;
    return now - *stopped_at_ < max_delay_ns;
  }

  void end() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    SteadyTime give_up = clocks::steady_now() + max_delay_ns;
    while (!queue_->ended) {
      const SteadyTime now = clocks::steady_now();
      if (when_full_ == FullQueuePolicy::wait && !is_stopped()) give_up = now + max_delay_ns;
      if (now >= give_up) return abandon();
      std::this_thread::sleep_for(wait_period);
    }
    thread_.join();
  }

  void abandon() {
    queue_->abandoned = true;
    queue_->lost += queue_->pushed - queue_->written;
    thread_.detach();
  }

  FullQueuePolicy when_full_;
  const process::StopSignal* stop_ = nullptr;
  std::optional<SteadyTime> stopped_at_;  ///< time at which a push first saw the stop
  std::shared_ptr<Queue> queue_;
  std::jthread thread_;
};

}  // namespace sonopose::publication
