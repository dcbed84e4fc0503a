#include "terminal/crash_restore.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <system_error>
#include <termios.h>
#include <unistd.h>

namespace sonopose::terminal {
namespace {

constexpr std::array crash_signals{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGQUIT, SIGHUP};

/// Everything that a signal handler reads.
struct Saved {
  volatile std::sig_atomic_t armed = 0;
  int terminal_fd = -1;
  int error_fd = -1;
  termios modes{};
  std::array<char, 512> sequence{};
  volatile std::size_t length = 0;
  std::array<struct sigaction, crash_signals.size()> actions{};
  std::terminate_handler terminate = nullptr;
};
Saved saved;

/// Once, even if several threads crash.
void restore() noexcept {
  if (saved.armed == 0) return;
  saved.armed = 0;
  [[maybe_unused]] const auto written = ::write(saved.terminal_fd, saved.sequence.data(), saved.length);
  ::tcsetattr(saved.terminal_fd, TCSANOW, &saved.modes);
  ::dup2(saved.error_fd, STDERR_FILENO);
}

extern "C" void sonopose_on_crash(int signal) {
  const int saved_errno = errno;
  restore();
  // The earlier action, mostly the default one, gets the signal when this handler returns.
  for (std::size_t i = 0; i < crash_signals.size(); ++i) {
    if (crash_signals[i] == signal) ::sigaction(signal, &saved.actions[i], nullptr);
  }
  ::raise(signal);
  errno = saved_errno;
}

[[noreturn]] void on_terminate() {
  restore();
  if (saved.terminate != nullptr) saved.terminate();
  std::abort();
}

}  // namespace

CrashRestore::CrashRestore(int terminal_fd, int error_fd) {
  saved.terminal_fd = terminal_fd;
  saved.error_fd = error_fd;
  saved.length = 0;
  if (::tcgetattr(terminal_fd, &saved.modes) != 0) {
    throw std::system_error(errno, std::generic_category(), "tcgetattr");
  }
  saved.armed = 1;
  struct sigaction action {};
  action.sa_handler = sonopose_on_crash;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < crash_signals.size(); ++i) {
    ::sigaction(crash_signals[i], &action, &saved.actions[i]);
  }
  saved.terminate = std::set_terminate(on_terminate);
}

void CrashRestore::leave_with(const std::string& sequence) {
  const std::size_t length = std::min(sequence.size(), saved.sequence.size());
  std::copy_n(sequence.begin(), length, saved.sequence.begin());
  saved.length = length;
}

void unblock_crash_signals() noexcept {
  thread_local bool done = false;
  if (done) return;
  done = true;
  sigset_t faults{};
  ::sigemptyset(&faults);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) ::sigaddset(&faults, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &faults, nullptr);
}

CrashRestore::~CrashRestore() {
  for (std::size_t i = 0; i < crash_signals.size(); ++i) {
    ::sigaction(crash_signals[i], &saved.actions[i], nullptr);
  }
  std::set_terminate(saved.terminate);
  saved.armed = 0;
}

}  // namespace sonopose::terminal
