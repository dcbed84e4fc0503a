#include "launch/together.hpp"

#include "files/descriptor.hpp"
#include "launch/execute.hpp"
#include "logging/log.hpp"
#include <sonopose/text/kept_lines.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <optional>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

// The header of glibc 2.36 lacks extern "C".
extern "C" {
#include <sys/pidfd.h>
}

namespace sonopose::launch {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds end_timeout{10};
constexpr std::chrono::seconds restore_timeout{1};  ///< wait after each of two requests
constexpr int cannot_execute = 127;

[[noreturn]] void fail(const char* call) {
  throw std::system_error(errno, std::generic_category(), call);
}

/// Receives SIGINT, SIGTERM, SIGHUP and SIGXCPU (out of processor time) as events. The programs get their
/// previous handling back.
class Signals {
public:
  Signals() {
    sigset_t mask;
    ::sigemptyset(&mask);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
      struct sigaction action {};
      if (::sigaction(signal, nullptr, &action) != 0) fail("sigaction");
      if (action.sa_handler != SIG_IGN)
        ::sigaddset(&mask, signal);  // stays ignored, as by nohup(1); a signalfd would receive it
    }
    if (::sigprocmask(SIG_BLOCK, &mask, &before_) != 0) fail("sigprocmask");
    file_ = files::Descriptor(::signalfd(-1, &mask, SFD_CLOEXEC | SFD_NONBLOCK));
    if (file_.number() < 0) fail("signalfd");
  }
  ~Signals() { restore(); }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  void restore() const { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  [[nodiscard]] int file() const { return file_.number(); }
  struct Taken {
    bool is_asked = false;        ///< by a person or a program
    bool is_out_of_time = false;  ///< SIGXCPU, which the kernel repeats each second
  };
  /// Returns the signals since the last call.
  [[nodiscard]] Taken take() const {
    signalfd_siginfo info{};
    Taken taken;
    while (::read(file_.number(), &info, sizeof info) == sizeof info) {
      (info.ssi_signo == SIGXCPU ? taken.is_out_of_time : taken.is_asked) = true;
    }
    return taken;
  }

private:
  sigset_t before_{};
  files::Descriptor file_;
};

class Child {
public:
  Child(const Program& program, const Signals& signals, ErrorOutput output)
      : name_(program.name), has_terminal_(program.has_terminal) {
    std::array<int, 2> ends{-1, -1};
    const bool is_kept = !program.has_terminal && output == ErrorOutput::keep;
    if (is_kept && ::pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe2");
    errors_ = files::Descriptor(ends[0]);
    const files::Descriptor writing(ends[1]);
    if (errors_.number() >= 0) ::fcntl(errors_.number(), F_SETFL, O_NONBLOCK);
    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ < 0) fail("fork");
    if (pid_ == 0) become(program, signals, parent, writing.number());
    handle_ = files::Descriptor(::pidfd_open(pid_, 0));
    if (handle_.number() >= 0) return;
    const int error = errno;
    end();  // no destructor runs
    errno = error;
    fail("pidfd_open");
  }
  ~Child() {
    if (!status_) end();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool has_terminal() const { return has_terminal_; }
  [[nodiscard]] int handle() const { return handle_.number(); }
  [[nodiscard]] int errors() const { return errors_.number(); }
  [[nodiscard]] bool has_ended() const { return status_.has_value(); }
  text::KeptLines& lines() { return lines_; }

  void read_errors() {
    std::array<char, 4096> buffer{};
    while (errors_.number() >= 0) {
      const ssize_t got = ::read(errors_.number(), buffer.data(), buffer.size());
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return;
      if (got == 0) errors_ = files::Descriptor();
      lines_.add({buffer.data(), static_cast<std::size_t>(got)});
    }
  }

  void reap() {
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) != pid_) return;
    status_ = status;
    read_errors();
    handle_ = files::Descriptor();
    errors_ = files::Descriptor();
  }

  void send(int signal) const {
    if (!status_) ::kill(pid_, signal);
  }

  /// Returns 0, the exit code, or 128 + signal. A signal that asked the program to end counts as 0.
  [[nodiscard]] int code(bool was_asked) const {
    if (WIFEXITED(*status_)) return WEXITSTATUS(*status_);
    const int signal = WTERMSIG(*status_);
    return was_asked && (signal == SIGTERM || signal == SIGINT || signal == SIGHUP) ? 0 : 128 + signal;
  }
  [[nodiscard]] std::string ending() const {
    if (WIFEXITED(*status_)) return fmt::format("ended with exit code {}", WEXITSTATUS(*status_));
    return fmt::format("was ended by signal {} ({})", WTERMSIG(*status_), ::strsignal(WTERMSIG(*status_)));
  }

private:
  void end() const {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

  [[noreturn]] void become(const Program& program, const Signals& signals, pid_t parent, int writing) const {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(cannot_execute);  // the parent died before prctl
    signals.restore();
    if (writing >= 0) {
      // Both ends let a program that briefly outlives this process still write its last lines.
      ::fcntl(errors_.number(), F_SETFD, 0);
      ::dup2(writing, STDERR_FILENO);
    }
    if (!program.has_terminal) {
      const int none = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
      ::dup2(none, STDIN_FILENO);
    }
    execute(program.name, program.arguments);
    logging::failure(fmt::format("{} cannot be started: {}", program.name, std::strerror(errno)));
    ::_exit(cannot_execute);
  }

  std::string name_;
  bool has_terminal_;
  text::KeptLines lines_;
  files::Descriptor errors_;
  files::Descriptor handle_;
  pid_t pid_ = -1;
  std::optional<int> status_;
};

class Group {
public:
  Group(const std::vector<Program>& programs, ErrorOutput output) {
    for (const Program& program : programs) {
      children_.push_back(std::make_unique<Child>(program, signals_, output));
    }
  }

  int run() {
    while (!have_all_ended()) {
      wait();
      look_for_signals();
      for (const auto& child : children_) look_at(*child);
      if (deadline_ && Clock::now() >= *deadline_) kill_rest();
    }
    // Standard error may be full or closed: that must not end this process.
    for (const auto& child : children_) {
      for (const std::string& line : child->lines().take()) std::fprintf(stderr, "%s\n", line.c_str());
    }
    for (const std::string& line : report_) logging::failure(line);
    return code_;
  }

private:
  [[nodiscard]] bool have_all_ended() const {
    return std::all_of(children_.begin(), children_.end(),
                       [](const auto& child) { return child->has_ended(); });
  }

  void wait() const {
    std::vector<pollfd> waited{{signals_.file(), POLLIN, 0}};
    for (const auto& child : children_) {
      if (child->handle() >= 0) waited.push_back({child->handle(), POLLIN, 0});
      if (child->errors() >= 0) waited.push_back({child->errors(), POLLIN, 0});
    }
    int timeout_ms = -1;
    if (deadline_) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(*deadline_ - Clock::now());
      timeout_ms = static_cast<int>(std::max<std::chrono::milliseconds::rep>(left.count(), 0));
    }
    ::poll(waited.data(), waited.size(), timeout_ms);
  }

  /// Forwards signals. timeout(1) and shells send a signal twice: only another one after a second kills the
  /// programs.
  void look_for_signals() {
    const Signals::Taken taken = signals_.take();
    if (taken.is_out_of_time && !deadline_) {
      report_.emplace_back("stopped: the limit of processor time is reached (ulimit -t)");
      end_rest();
    }
    if (!taken.is_asked) return;
    constexpr std::chrono::seconds repeat{1};
    const Clock::time_point now = Clock::now();
    if (signalled_at_ && now - *signalled_at_ > repeat) kill_rest();
    if (!signalled_at_) signalled_at_ = now;
    end_rest();
  }

  void look_at(Child& child) {
    if (child.has_ended()) return;
    child.read_errors();
    child.reap();
    if (!child.has_ended()) return;
    const int code = child.code(deadline_.has_value());
    if (code != 0) {
      if (code_ == 0) code_ = code;
      report_.push_back(fmt::format("{} {}{}", child.name(), child.ending(),
                                    deadline_ ? "" : "; the other programs were ended"));
    }
    end_rest();
  }

  /// Asks the remaining programs to end, once.
  void end_rest() {
    if (deadline_) return;
    deadline_ = Clock::now() + end_timeout;
    for (const auto& child : children_) child->send(SIGTERM);
  }

  /// Kills the remaining programs. One with the terminal restores it at a SIGTERM more than a second after
  /// its first one. It may have received the first one later than this process, so it is asked twice before.
  void kill_rest() {
    constexpr int max_requests = 2;
    const bool may_restore = kills_++ < max_requests;
    for (const auto& child : children_) child->send(may_restore && child->has_terminal() ? SIGTERM : SIGKILL);
    deadline_ = Clock::now() + (may_restore ? restore_timeout : end_timeout);
  }

  Signals signals_;
  std::vector<std::unique_ptr<Child>> children_;
  std::optional<Clock::time_point> deadline_;  ///< time of the kill; set when the end has begun
  std::optional<Clock::time_point> signalled_at_;
  int kills_ = 0;  ///< calls of kill_rest()
  std::vector<std::string> report_;
  int code_ = 0;
};

}  // namespace

int run_together(const std::vector<Program>& programs, ErrorOutput output) {
  return Group(programs, output).run();
}

}  // namespace sonopose::launch
