#include "support/terminal_process.hpp"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <system_error>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace sonopose::test {
namespace {

[[noreturn]] void throw_errno(const char* call) {
  throw std::system_error(errno, std::generic_category(), call);
}

winsize size_of(std::size_t columns, std::size_t rows) {
  return {static_cast<unsigned short>(rows), static_cast<unsigned short>(columns), 0, 0};
}

}  // namespace

TerminalProcess::TerminalProcess(const std::filesystem::path& program,
                                 const std::vector<std::string>& arguments, std::size_t columns,
                                 std::size_t rows, Environment environment)
    : screen_(columns, rows) {
  const winsize size = size_of(columns, rows);
  if (::openpty(&master_, &slave_, nullptr, nullptr, &size) != 0) throw_errno("openpty");
  ::fcntl(master_, F_SETFD, FD_CLOEXEC);
  environment.merge(Environment{{"NO_COLOR", ""}, {"COLUMNS", ""}, {"LINES", ""}, {"ESCDELAY", ""}});
  std::vector<std::string> command{program.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  child_.start(std::move(command), environment, [this] {
    ::setsid();
    ::ioctl(slave_, TIOCSCTTY, 0);
    for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(slave_, file);
  });
  listener_ = std::thread([this] { listen(); });
}

TerminalProcess::~TerminalProcess() {
  child_.kill();
  ending_ = true;
  if (listener_.joinable()) listener_.join();
  for (const int file : {slave_, master_}) ::close(file);
}

void TerminalProcess::listen() {
  constexpr int check_ending_ms = 20;
  while (!ending_) {
    pollfd waited{master_, POLLIN, 0};
    if (::poll(&waited, 1, check_ending_ms) > 0) take_in();
  }
}

void TerminalProcess::take_in() {
  std::array<char, 4096> buffer{};
  const ssize_t got = ::read(master_, buffer.data(), buffer.size());
  if (got <= 0) return;
  const std::string_view bytes(buffer.data(), static_cast<std::size_t>(got));
  const std::lock_guard lock(mutex_);
  screen_.feed(bytes);
  output_ += bytes;
  news_.notify_all();
}

void TerminalProcess::type(std::string_view keys) const {
  if (::write(master_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size()))
    throw_errno("write to a terminal");
}

void TerminalProcess::resize(std::size_t columns, std::size_t rows) {
  {
    const std::lock_guard lock(mutex_);
    screen_.resize(columns, rows);
  }
  const winsize size = size_of(columns, rows);
  if (::ioctl(master_, TIOCSWINSZ, &size) != 0) throw_errno("TIOCSWINSZ");
}

bool TerminalProcess::wait_until(const std::function<bool(const TextScreen&)>& done,
                                 std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  return news_.wait_for(lock, limit, [&] { return done(screen_); });
}

bool TerminalProcess::wait_for(std::string_view text, std::chrono::milliseconds limit) {
  return wait_until([text](const TextScreen& screen) { return screen.row_of(text) != std::string::npos; },
                    limit);
}

std::optional<int> TerminalProcess::wait_for_exit(std::chrono::milliseconds limit) {
  const std::optional<int> code = child_.wait_for_exit(limit);
  if (!code || !listener_.joinable()) return code;
  ending_ = true;
  listener_.join();
  pollfd left{master_, POLLIN, 0};
  while (::poll(&left, 1, 0) > 0) take_in();
  return code;
}

TextScreen TerminalProcess::screen() const {
  const std::lock_guard lock(mutex_);
  return screen_;
}

std::string TerminalProcess::output() const {
  const std::lock_guard lock(mutex_);
  return output_;
}

bool TerminalProcess::has_normal_line() const {
  termios modes{};
  if (::tcgetattr(slave_, &modes) != 0) throw_errno("tcgetattr");
  return (modes.c_lflag & ECHO) != 0 && (modes.c_lflag & ICANON) != 0;
}

}  // namespace sonopose::test
