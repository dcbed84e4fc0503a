#pragma once
/// \file
/// Runs asio operations with a timeout, and lets another thread end the wait. Internal to this module.

#include <asio/io_context.hpp>
#include <asio/post.hpp>

#include <atomic>
#include <chrono>

namespace sonopose::transport {

class StoppableLoop {
public:
  enum class Wait { finished, timed_out, stopped };

  asio::io_context& context() { return context_; }
  [[nodiscard]] bool stopped() const { return stopped_; }

  /// Runs handlers until one of them sets `finished`.
  Wait run_until(const bool& finished, std::chrono::steady_clock::time_point deadline) {
    context_.restart();
    while (!finished) {
      if (stopped_) return Wait::stopped;
      if (context_.run_one_until(deadline) == 0) return Wait::timed_out;
    }
    return Wait::finished;
  }

  /// Runs the handler of a cancelled operation, so that its buffer can be released.
  void drain(const bool& finished) {
    context_.restart();
    while (!finished) context_.run_one();
  }

  /// Stops the loop. The posted handler wakes run_until, even if posted before the wait begins. Thread-safe.
  void stop() {
    stopped_ = true;
    asio::post(context_, [] {});
  }

private:
  asio::io_context context_;
  std::atomic<bool> stopped_ = false;
};

/// Makes one asynchronous operation synchronous: `start(handler)` begins it, `cancel()` ends it early.
/// Returns its result; after a timeout, size 0 with operation_aborted.
struct Completion {
  bool finished = false;
  asio::error_code error;
  std::size_t size = 0;
};

template <class Start, class Cancel>
Completion complete_within(StoppableLoop& loop, std::chrono::milliseconds timeout, Start start,
                           Cancel cancel) {
  Completion completion;
  start([&completion](const asio::error_code& error, std::size_t size = 0) {
    completion = {true, error, size};
  });
  if (loop.run_until(completion.finished, std::chrono::steady_clock::now() + timeout) !=
      StoppableLoop::Wait::finished) {
    cancel();
    loop.drain(completion.finished);
  }
  return completion;
}

}  // namespace sonopose::transport
