#include "logging/log.hpp"

#include "logging/later.hpp"
#include "logging/line_format.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <memory>
#include <mutex>
#include <poll.h>
#include <pthread.h>
#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/sinks/base_sink.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace sonopose::logging {
namespace {

using spdlog::details::thread_pool;

constexpr std::chrono::milliseconds flush_timeout{1000};

/// Set once, before there are other threads.
std::string& program_name() {
  static std::string name = ::program_invocation_short_name;
  return name;
}

/// While it exists, a reader of standard error that has gone away does not end the process: a log is not
/// worth the poses.
class WithoutSigpipe {
public:
  WithoutSigpipe() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    ::sigpending(&pending);
    was_pending_ = ::sigismember(&pending, SIGPIPE) == 1;
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutSigpipe() {
    constexpr timespec at_once{};
    while (!was_pending_ && ::sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  WithoutSigpipe(const WithoutSigpipe&) = delete;
  WithoutSigpipe& operator=(const WithoutSigpipe&) = delete;

private:
  sigset_t pipe_{};
  sigset_t before_{};
  bool was_pending_ = false;  ///< from another write of this thread
};

/// Writes to standard error, which may take nothing for a while.
class PatientWriter {
public:
  /// Writes everything, or gives up after `flush_timeout` once the process is ending. `write` may block only
  /// after `poll`, and a pipe that is ready takes a line of up to 4096 bytes.
  void write(std::string_view text) {
    const WithoutSigpipe guard;
    while (!text.empty()) {
      if (!is_ready()) return;
      const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
      if (written < 0 && errno != EINTR && errno != EAGAIN) return;
      if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  /// From now on a standard error that takes nothing is not waited for.
  void end() { ending_ = true; }

private:
  bool is_ready() {
    constexpr int step_ms = 100;
    for (std::chrono::milliseconds waited{0}; !gave_up_; waited += std::chrono::milliseconds(step_ms)) {
      pollfd event{STDERR_FILENO, POLLOUT, 0};
      const int ready = ::poll(&event, 1, step_ms);
      if (ready > 0) return true;
      if (ready == 0 && ending_ && waited >= flush_timeout) gave_up_ = true;
    }
    return false;
  }

  std::atomic<bool> ending_ = false;
  bool gave_up_ = false;
};

Stream stream() {
  static const Stream found = stream_of(STDERR_FILENO, std::getenv("JOURNAL_STREAM"));
  return found;
}

void write_at_once(Level level, std::string_view text) {
  PatientWriter error;
  error.end();
  error.write(formatted(stream(), program_name(), level, text));
}

/// The calls of later() that wait for the thread of the session.
class WaitingCalls {
public:
  /// Returns whether no other call waited.
  bool add(std::function<void()> call) {
    const std::lock_guard lock(mutex_);
    if (calls_.size() < most) {
      calls_.push_back(std::move(call));
    } else {
      ++dropped_;
    }
    return calls_.size() == 1;
  }

  void make_all() {
    std::vector<std::function<void()>> calls;
    std::size_t dropped = 0;
    {
      const std::lock_guard lock(mutex_);
      calls.swap(calls_);
      dropped = std::exchange(dropped_, 0);
    }
    for (const auto& call : calls) {
      try {
        call();
      } catch (...) {  // there is no memory for its line
        ++dropped;
      }
    }
    if (dropped == 0) return;
    warning(fmt::format("{} not logged: too many at a time",
                        text::count_text(dropped, "change was", "changes were")));
  }

private:
  static constexpr std::size_t most = 2048;

  std::mutex mutex_;  // guards the rest
  std::vector<std::function<void()>> calls_;
  std::size_t dropped_ = 0;
};

/// All listeners. They are called under the lock, so none of them is called after its end.
class Listeners {
public:
  void add(Listener& listener) {
    const std::lock_guard lock(mutex_);
    entries_.push_back({&listener});
  }

  void remove(const Listener& listener) {
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [&](const Entry& entry) { return entry.listener == &listener; });
  }

  /// On the thread of the session; `earlier` are its lines before this one.
  void pass_on(const Line& line, const auto& earlier) {
    const std::lock_guard lock(mutex_);
    for (Entry& entry : entries_) {
      if (std::exchange(entry.is_new, false)) {
        for (const auto& each : earlier) entry.listener->on({each.level, each.time_ns, each.text});
      }
      entry.listener->on(line);
    }
  }

private:
  struct Entry {
    Listener* listener;
    bool is_new = true;
  };

  std::mutex mutex_;  // guards the rest
  std::vector<Entry> entries_;
};

Listeners& listeners() {
  static auto* const all = new Listeners;  // never destroyed: a listener may be a static object
  return *all;
}

/// Writes lines on the thread of the session, each before it reads the next: nothing is lost in a buffer.
class StandardError final : public spdlog::sinks::base_sink<std::mutex> {
public:
  explicit StandardError(Level least) : least_(least) {}

  /// `pool`: whose dropped lines it reports. It joins the thread that calls this sink, so it outlives all
  /// calls.
  void watch(thread_pool& pool) { pool_ = &pool; }

  void end() { error_.end(); }

  /// The thread of the session makes the call with the next line, which may be empty: then nothing is
  /// written. Returns whether no other call waited, so that this one needs such a line.
  bool add(std::function<void()> call) { return waiting_.add(std::move(call)); }

  /// The sink whose thread this is; null on any other one.
  static StandardError* of_this_thread() { return on_this_thread; }

  /// A line of the thread of the session, which follows those before it at once.
  void write_own(Level level, std::string_view text) {
    if (level >= least_) write(level, text);
  }

  /// Waits until the lines that were logged before are written, at most `flush_timeout`.
  void wait_for_flush(const auto& request) {
    std::unique_lock lock(flush_mutex_);
    const std::uint64_t before = flushes_;
    request();
    flushed_.wait_for(lock, flush_timeout, [&] { return flushes_ != before; });
  }

protected:
  void sink_it_(const spdlog::details::log_msg& line) override {
    time_ns_ = std::chrono::duration_cast<std::chrono::nanoseconds>(line.time.time_since_epoch()).count();
    report_dropped();
    on_this_thread = this;
    waiting_.make_all();
    if (line.payload.size() > 0) write(level_of(line.level), {line.payload.data(), line.payload.size()});
  }

  void flush_() override {
    report_dropped();
    on_this_thread = this;
    waiting_.make_all();
    const std::lock_guard lock(flush_mutex_);
    ++flushes_;
    flushed_.notify_all();
  }

private:
  static Level level_of(spdlog::level::level_enum level) {
    if (level <= spdlog::level::debug) return Level::debug;
    if (level == spdlog::level::info) return Level::info;
    if (level == spdlog::level::warn) return Level::warning;
    return level == spdlog::level::err ? Level::error : Level::failure;
  }

  struct Earlier {
    Level level;
    std::int64_t time_ns;
    std::string text;
  };

  void write(Level level, std::string_view text) {
    error_.write(formatted(stream(), program_name(), level, text));
    listeners().pass_on({level, time_ns_, text}, earlier_);
    if (earlier_.size() == Listening::most_earlier) earlier_.pop_front();
    earlier_.push_back({level, time_ns_, std::string(text)});
  }

  void report_dropped() {
    const std::size_t dropped = pool_->overrun_counter();
    if (dropped == reported_) return;
    const std::string text =
        fmt::format("{} dropped: standard error was too slow",
                    text::count_text(dropped - reported_, "line of this log was", "lines of this log were"));
    reported_ = dropped;
    write(Level::warning, text);
  }

  static thread_local StandardError* on_this_thread;

  Level least_;
  thread_pool* pool_ = nullptr;
  WaitingCalls waiting_;
  PatientWriter error_;
  std::size_t reported_ = 0;
  std::int64_t time_ns_ = 0;  ///< of the latest line
  std::deque<Earlier> earlier_;
  std::mutex flush_mutex_;
  std::condition_variable flushed_;
  std::uint64_t flushes_ = 0;
};

thread_local StandardError* StandardError::on_this_thread = nullptr;

spdlog::level::level_enum spdlog_level(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warning:
      return spdlog::level::warn;
    case Level::error:
      return spdlog::level::err;
    case Level::failure:
      return spdlog::level::critical;
  }
  return spdlog::level::critical;
}

/// What a session consists of. Shared, so that a line that is being logged keeps it alive.
struct Parts {
  Parts(Level least, std::size_t capacity)
      : pool(std::make_shared<thread_pool>(capacity, 1,
                                           [] { ::pthread_setname_np(::pthread_self(), "log"); })),
        sink(std::make_shared<StandardError>(least)),
        logger(std::make_shared<spdlog::async_logger>("", sink, pool,
                                                      spdlog::async_overflow_policy::overrun_oldest)) {
    sink->watch(*pool);
    logger->set_level(spdlog_level(least));
  }

  std::shared_ptr<thread_pool> pool;
  std::shared_ptr<StandardError> sink;
  std::shared_ptr<spdlog::async_logger> logger;
};

std::mutex session_mutex;
std::shared_ptr<Parts> session;  // null without one

std::shared_ptr<Parts> current() {
  const std::lock_guard lock(session_mutex);
  return session;
}

}  // namespace

void set_program(std::string name) {
  program_name() = std::move(name);
}

const std::string& program() {
  return program_name();
}

Listening::Listening(Listener& listener) : listener_(listener) {
  listeners().add(listener);
}

Listening::~Listening() {
  listeners().remove(listener_);
}

Session::Session(Level least, std::size_t capacity) {
  auto parts = std::make_shared<Parts>(least, capacity);
  const std::lock_guard lock(session_mutex);
  session = std::move(parts);
}

/// The end of the thread pool waits for the lines in its queue.
Session::~Session() {
  std::shared_ptr<Parts> parts;
  {
    const std::lock_guard lock(session_mutex);
    parts.swap(session);
  }
  parts->sink->end();
  parts->sink->wait_for_flush([&parts] { parts->logger->flush(); });
}

std::size_t Session::dropped() const {
  const auto parts = current();
  return parts ? parts->pool->overrun_counter() : 0;
}

void write(Level level, std::string_view text) noexcept {
  try {
    if (StandardError* const sink = StandardError::of_this_thread()) {
      sink->write_own(level, text);
    } else if (const auto parts = current()) {
      parts->logger->log(spdlog_level(level), spdlog::string_view_t(text.data(), text.size()));
    } else {
      write_at_once(level, text);
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for the line
  }
}

void later(std::function<void()> log) noexcept {
  try {
    const auto parts = current();
    if (!parts) return log();
    if (parts->sink->add(std::move(log))) {
      parts->logger->log(spdlog::level::critical, spdlog::string_view_t());
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for the line
  }
}

void failure(std::string_view text) noexcept {
  write(Level::failure, text);
  try {
    const auto parts = current();
    if (parts) parts->sink->wait_for_flush([&parts] { parts->logger->flush(); });
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory to wait with
  }
}

}  // namespace sonopose::logging
