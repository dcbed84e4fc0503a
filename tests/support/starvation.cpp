// Skips a failed test of processes if the machine did not run them: its failure then says nothing about them.

#define CATCH_CONFIG_EXTERNAL_INTERFACES  // the listener
#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <optional>
#include <thread>

namespace sonopose::test::starvation {
namespace {

using std::chrono::milliseconds;

/// Longest time by which a thread woke too late, in a thread of its own.
class WakeUpDelay {
public:
  [[nodiscard]] milliseconds longest() const { return milliseconds(longest_ms_.load()); }

private:
  void measure(const std::stop_token& stop) {
    constexpr milliseconds period{20};
    while (!stop.stop_requested()) {
      const auto due = std::chrono::steady_clock::now() + period;
      std::this_thread::sleep_until(due);
      const auto late = std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - due);
      longest_ms_ = std::max<std::int64_t>(longest_ms_, late.count());
    }
  }

  /// Signals are for the threads of the test.
  std::jthread start() {
    sigset_t all;
    sigset_t before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    std::jthread thread([this](const std::stop_token& stop) { measure(stop); });
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return thread;
  }

  std::atomic<std::int64_t> longest_ms_ = 0;
  std::jthread thread_ = start();
};

struct Listener : Catch::TestEventListenerBase {
  using TestEventListenerBase::TestEventListenerBase;

  void testCaseStarting(const Catch::TestCaseInfo& /*test*/) override { delay_.emplace(); }

  void testCaseEnded(const Catch::TestCaseStats& stats) override {
    constexpr milliseconds limit{250};  // a quarter of a fusion's lease
    const milliseconds longest = delay_->longest();
    delay_.reset();
    if (stats.totals.assertions.failed == 0 || longest < limit) return;
    std::cout << "skipped: it failed, but the machine left a waiting thread of the test alone for "
              << longest.count() << " ms: run it with less other work\n";
  }

private:
  std::optional<WakeUpDelay> delay_;
};

CATCH_REGISTER_LISTENER(Listener)

}  // namespace
}  // namespace sonopose::test::starvation
