#pragma once
/// \file
/// Writes files on a thread of its own, so that a slow or full disk does not delay what is published.

#include "files/error.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace sonopose::bridge {

/// What happens if the disk is slower than the source.
enum class WhenFull : std::uint8_t {
  lose,  ///< the item is lost and counted: for live data
  wait   ///< until there is space: for data that can wait
};

/// A bounded queue from one thread to the writing thread, without locks. The first error of `write` ends the
/// writing and is logged. Lost items are counted and logged.
template <class Item>
class BackgroundWriter {
public:
  using Write = std::function<void(std::span<const Item>)>;

  /// What messages call it: "the recording" lacks "samples".
  struct Words {
    std::string name;
    std::string items;
  };

  /// `write` takes items in their order and throws if it cannot write them.
  BackgroundWriter(Words words, std::size_t capacity, WhenFull when_full, Write write)
      : words_(std::move(words)), when_full_(when_full), write_(std::move(write)), ring_(capacity) {
    thread_ = std::jthread([this](const std::stop_token& end) { serve(end); });
  }
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;
  BackgroundWriter(BackgroundWriter&&) = delete;
  BackgroundWriter& operator=(BackgroundWriter&&) = delete;
  /// Waits until everything has been written, without a report.
  ~BackgroundWriter() = default;

  /// Takes all of the items, at most `capacity`, or loses all. Does not allocate. One thread only.
  void push(std::span<const Item> items) {
    while (when_full_ == WhenFull::wait && !failed_ && free_space() < items.size()) {
      std::this_thread::sleep_for(wait_period);
    }
    if (failed_ || free_space() < items.size()) {
      lost_ += items.size();
      return;
    }
    const std::uint64_t end = pushed_.load(std::memory_order_relaxed);
    for (std::size_t i = 0; i < items.size(); ++i) ring_[(end + i) % ring_.size()] = items[i];
    pushed_.store(end + items.size(), std::memory_order_release);
  }

  /// Waits until everything has been written; nothing may be pushed afterwards. Throws files::IoError if
  /// items were lost.
  void finish() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
    if (lost_ > 0) throw files::IoError(lost_words());
  }

  /// Items that were not written, because of an error or a full queue. From any thread.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

private:
  static constexpr std::chrono::milliseconds wait_period{1};
  static constexpr std::chrono::milliseconds write_period{20};
  static constexpr int rounds_per_report = 50;

  [[nodiscard]] std::size_t free_space() const {
    return ring_.size() -
           (pushed_.load(std::memory_order_relaxed) - written_.load(std::memory_order_acquire));
  }

  void serve(const std::stop_token& end) {
    bool is_last = false;
    for (int round = 1; !is_last; ++round) {
      is_last = end.stop_requested();  // before the look at the queue: nothing is pushed after it
      write_all();
      if (!failed_ && round % rounds_per_report == 0) report_lost();
      if (!is_last) std::this_thread::sleep_for(write_period);
    }
  }

  void write_all() {
    const std::uint64_t end = pushed_.load(std::memory_order_acquire);
    for (std::uint64_t begin = written_.load(std::memory_order_relaxed); begin != end;) {
      const std::size_t first = begin % ring_.size();
      const std::size_t count = std::min<std::uint64_t>(end - begin, ring_.size() - first);
      write(std::span(ring_).subspan(first, count));
      begin += count;
      written_.store(begin, std::memory_order_release);
    }
  }

  void write(std::span<const Item> items) {
    if (!failed_) {
      try {
        write_(items);
        return;
      } catch (const std::exception& error) {
        failed_ = true;
        logging::error(fmt::format("{} has ended: {}; publishing continues", words_.name, error.what()));
      }
    }
    lost_ += items.size();
  }

  void report_lost() {
    const std::uint64_t lost = lost_;
    if (std::exchange(reported_, lost) == lost) return;
    logging::warning(lost_words());
  }

  [[nodiscard]] std::string lost_words() const {
    return fmt::format("{} lacks {} {}: the disk is too slow or full", words_.name, lost_.load(),
                       words_.items);
  }

  Words words_;
  WhenFull when_full_;
  Write write_;
  std::vector<Item> ring_;
  std::atomic<std::uint64_t> pushed_ = 0;   ///< since the start; the place in the ring is the remainder
  std::atomic<std::uint64_t> written_ = 0;  ///< since the start, including lost ones
  std::atomic<std::uint64_t> lost_ = 0;
  std::uint64_t reported_ = 0;  ///< of the lost ones
  std::atomic<bool> failed_ = false;
  std::jthread thread_;  ///< last: it ends before the rest
};

}  // namespace sonopose::bridge
