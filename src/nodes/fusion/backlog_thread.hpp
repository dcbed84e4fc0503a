#pragma once
/// \file
/// A thread that works when woken.

#include "process/realtime.hpp"

#include <atomic>
#include <cstdint>
#include <pthread.h>
#include <thread>

namespace sonopose::fusion {

/// A thread that sleeps until woken. Waking it costs a system call only if it sleeps.
class BacklogThread {
public:
  BacklogThread() = default;
  BacklogThread(const BacklogThread&) = delete;
  BacklogThread& operator=(const BacklogThread&) = delete;
  ~BacklogThread() { stop(); }

  /// Calls `work()` until it has started after the latest `wake`, then `rest()`, and waits.
  void start(const auto& work, const auto& rest) {
    thread_ = std::jthread([=, this](const std::stop_token& stop) {
      std::uint64_t seen = 0;
      while (!stop.stop_requested()) {
        wakes_.wait(seen);
        for (std::uint64_t wakes = wakes_; wakes != seen; wakes = wakes_) {
          seen = wakes;
          work();
        }
        rest();
      }
    });
    ::pthread_setname_np(thread_.native_handle(), process::backlog_thread_name);
  }

  void wake() noexcept {
    wakes_.fetch_add(1);
    wakes_.notify_one();
  }

  /// Waits until the thread has ended.
  void stop() {
    thread_.request_stop();
    wake();
    thread_ = {};
  }

private:
  std::atomic<std::uint64_t> wakes_ = 0;
  std::jthread thread_;
};

}  // namespace sonopose::fusion
