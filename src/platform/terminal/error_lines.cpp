#include "terminal/error_lines.hpp"

#include "terminal/crash_restore.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace sonopose::terminal {
namespace {

void require(bool good, const char* call) {
  if (!good) throw std::system_error(errno, std::generic_category(), call);
}

void write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;  // there is nowhere to report it
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

ErrorLines::ErrorLines()
    : original_(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)),
      on_terminal_(::isatty(STDERR_FILENO) == 1) {
  require(original_.number() >= 0, "dup of standard error");
  std::array<int, 2> ends{};
  require(::pipe2(ends.data(), O_CLOEXEC) == 0, "pipe2");
  pipe_ = files::Descriptor(ends[0]);
  const files::Descriptor writing(ends[1]);
  // Signals are for the main thread.
  sigset_t all{};
  sigset_t before{};
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  if (on_terminal_) CrashRestore::read_from(pipe_.number());  // elsewhere each line is passed on immediately
  try {
    reader_ = std::thread([this] { read_lines(); });
  } catch (...) {
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    CrashRestore::read_from(-1);
    throw;
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  std::fflush(stderr);
  ::dup2(writing.number(), STDERR_FILENO);
}

ErrorLines::~ErrorLines() {
  std::fflush(stderr);
  ::dup2(original_.number(), STDERR_FILENO);  // closes the last write end, so the reader ends
  reader_.join();
  CrashRestore::read_from(-1);
  if (on_terminal_) {
    for (const std::string& line : kept_.take()) write_all(STDERR_FILENO, line + "\n");
  }
}

std::vector<std::string> ErrorLines::take() {
  const threads::Lock lock(mutex_);
  return std::exchange(new_lines_, {});
}

void ErrorLines::read_lines() {
  unblock_crash_signals();
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t got = ::read(pipe_.number(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    if (on_terminal_) CrashRestore::keep({buffer.data(), static_cast<std::size_t>(got)});
    kept_.add({buffer.data(), static_cast<std::size_t>(got)},
              [this](const std::string& line) { on_line(line); });
  }
}

void ErrorLines::on_line(const std::string& line) {
  if (!on_terminal_) write_all(original_.number(), line + "\n");
  const threads::Lock lock(mutex_);
  if (new_lines_.size() < text::KeptLines::max_lines) new_lines_.push_back(line);
}

}  // namespace sonopose::terminal
