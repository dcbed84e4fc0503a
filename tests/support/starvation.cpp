// Skips a failed test of processes if the machine did not run them: its failure then says nothing about them.

#define CATCH_CONFIG_EXTERNAL_INTERFACES  // the listener
#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <iostream>
#include <optional>
#include <string>
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

/// Time that passes while this thread computes for 0.1 s, per time that it computes: about 1 if a core is
/// free.
double slowdown() {
  const auto computed = [] {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  };
  constexpr std::chrono::duration<double> wanted{0.1};
  const auto began = std::chrono::steady_clock::now();
  const auto before = computed();
  while (computed() - before < wanted) {
  }
  return (std::chrono::steady_clock::now() - began) / wanted;
}

struct Listener : Catch::TestEventListenerBase {
  using TestEventListenerBase::TestEventListenerBase;

  void testCaseStarting(const Catch::TestCaseInfo& /*test*/) override { delay_.emplace(); }

  void testCaseEnded(const Catch::TestCaseStats& stats) override {
    constexpr milliseconds limit{250};  // a quarter of a fusion's lease
    const milliseconds longest = delay_->longest();
    delay_.reset();
    if (stats.totals.assertions.failed == 0) return;
    std::string why;
    if (longest >= limit) {
      why = "left a waiting thread of the test alone for " + std::to_string(longest.count()) + " ms";
    } else if (const double factor = slowdown(); factor >= 2) {
      why =
          "let a computing thread of the test take " + std::to_string(std::lround(factor)) + " times as long";
    } else {
      return;
    }
    std::cout << "skipped: it failed, but the machine " << why << ": run it with less other work\n";
  }

private:
  std::optional<WakeUpDelay> delay_;
};

CATCH_REGISTER_LISTENER(Listener)

}  // namespace
}  // namespace sonopose::test::starvation
