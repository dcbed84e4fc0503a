#include "terminal/crash_restore.hpp"

#include "terminal/foreground.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <poll.h>
#include <system_error>
#include <termios.h>
#include <unistd.h>

namespace sonopose::terminal {
namespace {

constexpr std::array crash_signals{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGQUIT};

/// The state that a signal handler reads.
struct Saved {
  std::atomic<bool> armed = false;
  int terminal_fd = -1;
  int error_fd = -1;
  termios modes{};
  std::array<char, 512> sequence{};
  volatile std::size_t length = 0;
  std::array<struct sigaction, crash_signals.size()> actions{};
  std::terminate_handler terminate = nullptr;
};
Saved saved;

/// The latest text on standard error, in a form that a crash handler can read, unlike a container.
struct RecentErrorText {
  std::array<char, 16384> text{};
  std::atomic<std::size_t> size = 0;  ///< bytes ever written; each is stored at its number modulo the length
  std::atomic<int> pipe_fd = -1;
};
RecentErrorText recent_text;
static_assert(std::atomic<std::size_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

void write_to_error(const char* text, std::size_t size) noexcept {
  while (size > 0) {
    const ssize_t written = ::write(STDERR_FILENO, text, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text += written;
    size -= static_cast<std::size_t>(written);
  }
}

/// Makes only async-signal-safe calls.
void write_kept() noexcept {
  const int fd = recent_text.pipe_fd;
  if (fd < 0) return;
  const std::size_t size = recent_text.size;
  const std::size_t length = std::min(size, recent_text.text.size());
  const std::size_t begin = (size - length) % recent_text.text.size();
  const std::size_t first = std::min(length, recent_text.text.size() - begin);
  write_to_error(recent_text.text.data() + begin, first);
  write_to_error(recent_text.text.data(), length - first);
  constexpr int max_reads = 64;  // other threads may continue to write
  std::array<char, 1024> rest{};
  for (int i = 0; i < max_reads; ++i) {
    pollfd event{fd, POLLIN, 0};
    if (::poll(&event, 1, 0) <= 0 || (event.revents & POLLIN) == 0) return;
    const ssize_t got = ::read(fd, rest.data(), rest.size());
    if (got <= 0) return;
    write_to_error(rest.data(), static_cast<std::size_t>(got));
  }
}

/// Restores once, even if several threads crash.
void restore() noexcept {
  if (!saved.armed.exchange(false)) return;
  if (!is_in_background(saved.terminal_fd)) {
    ::tcsetattr(saved.terminal_fd, TCSANOW, &saved.modes);
    [[maybe_unused]] const auto written = ::write(saved.terminal_fd, saved.sequence.data(), saved.length);
  }
  ::dup2(saved.error_fd, STDERR_FILENO);
  write_kept();
}

extern "C" void sonopose_on_crash(int signal) {
  const int saved_errno = errno;
  restore();
  // The earlier action, usually the default one, gets the signal when this handler returns.
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
  saved.armed = true;
  struct sigaction action {};
  action.sa_handler = sonopose_on_crash;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < crash_signals.size(); ++i) {
    ::sigaction(crash_signals[i], &action, &saved.actions[i]);
  }
  saved.terminate = std::set_terminate(on_terminate);
}

void CrashRestore::read_from(int fd) noexcept {
  recent_text.size = 0;
  recent_text.pipe_fd = fd;
}

void CrashRestore::keep(std::string_view text) noexcept {
  if (text.size() > recent_text.text.size()) text.remove_prefix(text.size() - recent_text.text.size());
  std::size_t size = recent_text.size;
  for (const char byte : text) recent_text.text[size++ % recent_text.text.size()] = byte;
  recent_text.size = size;
}

void CrashRestore::restore_now() noexcept {
  restore();
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
  saved.armed = false;
}

}  // namespace sonopose::terminal
