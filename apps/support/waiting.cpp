#include "waiting.hpp"

#include <fmt/format.h>

#include <csignal>
#include <limits>
#include <unistd.h>
#include <utility>

namespace sonopose::apps {

Waiting::Waiting(std::string what, double expected_s) : what_(std::move(what)), expected_s_(expected_s) {
  if (::isatty(STDERR_FILENO) != 1) return;
  // Signals are for the main thread.
  sigset_t all{};
  sigset_t before{};
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { show(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Waiting::~Waiting() {
  if (!thread_.joinable()) return;
  {
    const threads::Lock lock(mutex_);
    ended_ = true;
  }
  change_.notify_one();
  thread_.join();
}

void Waiting::show() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds period(100);
  const Clock::time_point began = Clock::now();
  threads::Lock lock(mutex_);
  const auto has_ended = [this] {
    mutex_.assert_held();
    return ended_;
  };
  while (!change_.wait_for(lock, period, has_ended)) {
    const double passed_s = std::chrono::duration<double>(Clock::now() - began).count();
    const bool has_share = passed_s < expected_s_;
    progress_.at(has_share ? passed_s / expected_s_ : std::numeric_limits<double>::quiet_NaN(),
                 fmt::format("{}, {:.0f} s", what_, passed_s));
  }
}

}  // namespace sonopose::apps
