#pragma once
/// \file
/// Queues calls for the thread of the log.

#include "threads/mutex.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

namespace sonopose::logging {

/// A queue of calls. Thread-safe.
class WaitingCalls {
public:
  static constexpr std::size_t max_calls = 2048;  ///< further calls are dropped

  using Number = std::uint32_t;  ///< number of a call; it wraps around

  /// Returns the call's number; empty if it is dropped.
  std::optional<Number> add(std::function<void()> call) {
    const threads::Lock lock(mutex_);
    if (calls_.size() == max_calls) {
      ++dropped_;
      return std::nullopt;
    }
    calls_.push_back({++latest_, std::move(call)});
    return latest_;
  }

  /// Makes the calls up to this number. Returns how many were dropped or failed since the last time.
  std::size_t make_up_to(Number number) {
    std::size_t failed = 0;
    while (const auto call = take_up_to(number)) {
      try {
        call();
      } catch (...) {  // there is no memory for its line
        ++failed;
      }
    }
    const threads::Lock lock(mutex_);
    return std::exchange(dropped_, 0) + failed;
  }

  [[nodiscard]] Number latest() const {
    const threads::Lock lock(mutex_);
    return latest_;
  }

private:
  struct Call {
    Number number;
    std::function<void()> make;
  };

  /// Returns the first call up to this number; null if there is none.
  std::function<void()> take_up_to(Number number) {
    const threads::Lock lock(mutex_);
    if (calls_.empty() || static_cast<std::int32_t>(number - calls_.front().number) < 0) return nullptr;
    std::function<void()> call = std::move(calls_.front().make);
    calls_.pop_front();
    return call;
  }

  mutable threads::Mutex mutex_;
  std::deque<Call> calls_ SONOPOSE_GUARDED_BY(mutex_);
  Number latest_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::size_t dropped_ SONOPOSE_GUARDED_BY(mutex_) = 0;
};

}  // namespace sonopose::logging
