#include "process/stop_signal.hpp"

#include "clocks/clocks.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <poll.h>
#include <sys/eventfd.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::process {
namespace {

// The signal handler may use only a lock-free atomic and write(2).
std::atomic<int> signalled_fd{-1};
static_assert(std::atomic<int>::is_always_lock_free);

void raise_event(int fd) noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(fd, &one, sizeof one);
}

extern "C" void sonopose_on_stop_signal(int /*signal*/) {
  const int saved_errno = errno;
  if (const int fd = signalled_fd.load(); fd >= 0) raise_event(fd);
  errno = saved_errno;
}

bool is_readable(int fd, TimeNs timeout_ns) {
  const TimeNs whole_s = timeout_ns / 1'000'000'000;
  const timespec timeout{static_cast<std::time_t>(whole_s), static_cast<long>(timeout_ns % 1'000'000'000)};
  pollfd waited{fd, POLLIN, 0};
  return ::ppoll(&waited, 1, &timeout, nullptr) > 0;
}

}  // namespace

StopSignal::StopSignal() : event_fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

StopSignal::~StopSignal() {
  int mine = event_fd_;
  signalled_fd.compare_exchange_strong(mine, -1);
  ::close(event_fd_);
}

void StopSignal::listen_to_signals() {
  signalled_fd.store(event_fd_);
  struct sigaction action {};
  action.sa_handler = sonopose_on_stop_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    if (::sigaction(signal, &action, nullptr) != 0) {
      throw std::system_error(errno, std::generic_category(), "sigaction");
    }
  }
}

void StopSignal::request() noexcept {
  raise_event(event_fd_);
}

bool StopSignal::requested() const noexcept {
  return is_readable(event_fd_, 0);
}

bool StopSignal::wait_until(SteadyTime deadline) const {
  TimeNs left_ns = deadline - clocks::steady_now();
  if (left_ns <= 0) return requested();
  while (left_ns > 0) {
    if (is_readable(event_fd_, left_ns)) return true;
    left_ns = deadline - clocks::steady_now();  // a signal may have cut the sleep short
  }
  return false;
}

}  // namespace sonopose::process
