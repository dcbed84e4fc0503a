#include "process/stop_signal.hpp"

#include "clocks/clocks.hpp"
#include "process/emergency_cleanup.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <poll.h>
#include <span>
#include <string_view>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::process {
namespace {

// The signal handler may use only lock-free atomics, async-signal-safe calls and the steady clock.
std::atomic<int> signalled_fd{-1};
static_assert(std::atomic<int>::is_always_lock_free);

void raise_event(int fd) noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(fd, &one, sizeof one);
}

/// Separates a second signal by a waiting person from the group of signals that all programs of a terminal
/// receive together.
constexpr TimeNs repeated_after_ns = 1'000'000'000;
std::atomic<TimeNs> signalled_ns{0};
static_assert(std::atomic<TimeNs>::is_always_lock_free);

std::atomic<EmergencyCleanup> emergency_cleanup{nullptr};
static_assert(std::atomic<EmergencyCleanup>::is_always_lock_free);
std::atomic<bool> is_ending{false};
static_assert(std::atomic<bool>::is_always_lock_free);

/// Ends the process. Returns only if another thread is already here: a further signal must not cut the call
/// short.
void terminate_now(int signal) noexcept {
  if (is_ending.exchange(true)) return;
  if (const EmergencyCleanup call = emergency_cleanup.load()) {
    constexpr unsigned max_wait_s = 1;  // a terminal may block forever; SIGALRM then ends the process
    ::signal(SIGALRM, SIG_DFL);
    sigset_t alarm{};  // a parent may have blocked it
    ::sigemptyset(&alarm);
    ::sigaddset(&alarm, SIGALRM);
    ::pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
    ::alarm(max_wait_s);
    call();
  }
  ::_exit(128 + signal);
}

/// Signals that request the stop. The kernel sends SIGXCPU at the soft limit of processor time, and again
/// after each further second.
constexpr std::array stop_signals{SIGINT, SIGTERM, SIGHUP, SIGXCPU};

std::atomic<bool> is_out_of_time{false};

/// Says once why the process stops, since nobody has asked for it.
void report_out_of_time() noexcept {
  constexpr std::string_view text = "stopping: the limit of processor time is reached (ulimit -t)\n";
  if (is_out_of_time.exchange(true)) return;
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

extern "C" void sonopose_on_stop_signal(int signal) {
  const int saved_errno = errno;
  if (signal == SIGXCPU) report_out_of_time();
  if (signal == SIGINT || signal == SIGTERM) {      // only these come from a person who waits
    const TimeNs now_ns = clocks::steady_now().ns;  // neither allocates nor locks
    TimeNs first_ns = 0;
    if (!signalled_ns.compare_exchange_strong(first_ns, now_ns) && now_ns - first_ns > repeated_after_ns) {
      terminate_now(signal);
    }
  }
  if (const int fd = signalled_fd.load(); fd >= 0) raise_event(fd);
  errno = saved_errno;
}

files::Descriptor make_event() {
  files::Descriptor event(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (event.number() < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  return event;
}

timespec to_timespec(TimeNs ns) {
  return {static_cast<std::time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
}

/// Waits until one of `events` is readable.
bool wait_for(std::span<pollfd> events, TimeNs timeout_ns) {
  const timespec timeout = to_timespec(timeout_ns);
  return ::ppoll(events.data(), events.size(), &timeout, nullptr) > 0;
}

bool is_readable(int fd, TimeNs timeout_ns) {
  pollfd event{fd, POLLIN, 0};
  return wait_for({&event, 1}, timeout_ns);
}

}  // namespace

void set_emergency_cleanup(EmergencyCleanup call) noexcept {
  emergency_cleanup.store(call);
}

Wakeup::Wakeup() : event_(make_event()) {}

void Wakeup::wake() noexcept {
  raise_event(event_.number());
}

Alarm::Alarm() : timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)) {
  if (timer_.number() < 0) throw std::system_error(errno, std::generic_category(), "timerfd_create");
}

void Alarm::set(SteadyTime at) noexcept {
  at_ns_.store(at.ns);
  const TimeNs at_ns = std::max<TimeNs>(at.ns, 1);  // 0 would disarm it
  itimerspec once{};
  once.it_value = to_timespec(at_ns);
  ::timerfd_settime(timer_.number(), TFD_TIMER_ABSTIME, &once, nullptr);
}

StopSignal::StopSignal() : event_(make_event()) {}

StopSignal::~StopSignal() {
  int mine = event_.number();
  signalled_fd.compare_exchange_strong(mine, -1);
}

void StopSignal::listen_to_signals() {
  signalled_ns.store(0);
  signalled_fd.store(event_.number());
  struct sigaction action {};
  action.sa_handler = sonopose_on_stop_signal;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  for (const int signal : stop_signals) ::sigaddset(&action.sa_mask, signal);
  for (const int signal : stop_signals) {
    struct sigaction before {};
    const bool is_hangup_ignored =
        signal == SIGHUP && ::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
    if (is_hangup_ignored) continue;  // as by nohup(1)
    if (::sigaction(signal, &action, nullptr) != 0) {
      throw std::system_error(errno, std::generic_category(), "sigaction");
    }
  }
}

void StopSignal::request() noexcept {
  raise_event(event_.number());
}

bool StopSignal::requested() const noexcept {
  return is_readable(event_.number(), 0);
}

bool StopSignal::wait_until(SteadyTime deadline) const {
  TimeNs left_ns = deadline - clocks::steady_now();
  if (left_ns <= 0) return requested();
  while (left_ns > 0) {
    if (is_readable(event_.number(), left_ns)) return true;
    left_ns = deadline - clocks::steady_now();  // a signal may have cut the sleep short
  }
  return false;
}

bool StopSignal::wait_until(SteadyTime deadline, Wakeup& wakeup) const {
  return wait_until(deadline, wakeup.event_.number());
}

bool StopSignal::wait_until(SteadyTime deadline, Alarm& alarm) const {
  return wait_until(deadline, alarm.timer_.number());
}

bool StopSignal::wait_until(SteadyTime deadline, int other_fd) const {
  // A signal that cuts the sleep short only wakes the caller early.
  std::array<pollfd, 2> events{{{event_.number(), POLLIN, 0}, {other_fd, POLLIN, 0}}};
  wait_for(events, std::max<TimeNs>(deadline - clocks::steady_now(), 0));
  std::uint64_t count = 0;
  [[maybe_unused]] const auto consumed = ::read(other_fd, &count, sizeof count);
  return requested();
}

}  // namespace sonopose::process
