#include "logging/standard_error.hpp"

#include "logging/line_format.hpp"
#include "logging/spdlog_entry.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace sonopose::logging {
namespace {

/// Blocks SIGPIPE during its lifetime: a reader of standard error that has gone away must not end the
/// process.
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
  bool was_pending_ = false;  ///< SIGPIPE from another write of this thread
};

/// Variant of write(2) that fails with EAGAIN instead of waiting. O_NONBLOCK on standard error itself would
/// affect every process that shares it, so a pipe or terminal is opened again. poll(2) does not suffice: a
/// terminal reports ready without space for a line.
ssize_t write_without_waiting(std::string_view text) {
  struct stat file {};
  if (::fstat(STDERR_FILENO, &file) == 0 && (S_ISFIFO(file.st_mode) || S_ISCHR(file.st_mode))) {
    const int own = ::open("/proc/self/fd/2", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (own >= 0) {
      const ssize_t written = ::write(own, text.data(), text.size());
      const int error = errno;
      ::close(own);
      errno = error;
      return written;
    }
  }
  pollfd event{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&event, 1, 0) > 0) return ::write(STDERR_FILENO, text.data(), text.size());
  errno = EAGAIN;
  return -1;
}

std::string line_of(Level level, std::string_view text) {
  static const Stream stream = stream_of(STDERR_FILENO, std::getenv("JOURNAL_STREAM"));
  return formatted(stream, program(), level, text);
}

}  // namespace

void ErrorWriter::write(std::string_view text) {
  constexpr std::chrono::milliseconds step{20};
  const WithoutSigpipe guard;
  std::chrono::milliseconds waited{0};
  while (!text.empty() && !gave_up_) {
    const ssize_t written = write_without_waiting(text);
    if (written > 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
      waited = std::chrono::milliseconds(0);
    } else if (written < 0 && errno == EAGAIN) {
      std::this_thread::sleep_for(step);
      waited += step;
      gave_up_ = ending_ && waited >= write_timeout;
    } else if (written < 0 && errno != EINTR) {
      return;
    }
  }
}

void write_at_once(Level level, std::string_view text) {
  ErrorWriter error;
  error.end();
  error.write(line_of(level, text));
}

/// Writes each line before it reads the next: no buffer can lose lines.
class StandardError::Sink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
public:
  /// `pool`: source of dropped lines. It joins the thread that calls this sink, so it outlives all calls.
  Sink(spdlog::details::thread_pool& pool, Flushes& flushes) : pool_(pool), flushes_(flushes) {}

  void end() { writer_.end(); }

protected:
  void sink_it_(const spdlog::details::log_msg& entry) override {
    report_dropped();
    if (is_mark(entry.source, flush_mark)) return finish(number_of(entry.source));
    writer_.write(line_of(level_of(entry.level), {entry.payload.data(), entry.payload.size()}));
  }

  void flush_() override {}

private:
  void finish(FlushNumber number) {
    const threads::Lock lock(flushes_.mutex);
    flushes_.finished = number;
    flushes_.changed.notify_all();
  }

  void report_dropped() {
    const std::size_t dropped = pool_.overrun_counter();
    if (dropped == reported_) return;
    const std::string text =
        fmt::format("{} dropped: standard error was too slow",
                    text::count_text(dropped - reported_, "line of this log was", "lines of this log were"));
    reported_ = dropped;
    writer_.write(line_of(Level::warning, text));
  }

  spdlog::details::thread_pool& pool_;
  Flushes& flushes_;
  ErrorWriter writer_;
  std::size_t reported_ = 0;
};

StandardError::StandardError(std::size_t capacity)
    : pool_(std::make_shared<spdlog::details::thread_pool>(
          capacity, 1, [] { ::pthread_setname_np(::pthread_self(), "log-stderr"); })),
      sink_(std::make_shared<Sink>(*pool_, flushes_)),
      logger_(std::make_shared<spdlog::async_logger>("", sink_, pool_,
                                                     spdlog::async_overflow_policy::overrun_oldest)) {
  logger_->set_level(spdlog::level::trace);
}

StandardError::~StandardError() {
  sink_->end();
  logger_.reset();
  pool_.reset();  // joins its thread, which uses the sink
}

void StandardError::write(Level level, std::string_view text) {
  logger_->log(spdlog_level(level), spdlog::string_view_t(text.data(), text.size()));
}

std::size_t StandardError::dropped() const {
  return pool_->overrun_counter();
}

StandardError::FlushNumber StandardError::next_flush() {
  const threads::Lock lock(flushes_.mutex);
  return ++flushes_.requested;
}

void StandardError::flush(FlushNumber number) {
  logger_->log(mark(flush_mark, number), spdlog::level::critical, spdlog::string_view_t());
}

void StandardError::wait_for_flush(FlushNumber number) {
  threads::Lock lock(flushes_.mutex);
  flushes_.changed.wait_for(lock, write_timeout, [&] {
    flushes_.mutex.assert_held();
    return static_cast<std::int32_t>(flushes_.finished - number) >= 0;
  });
}

}  // namespace sonopose::logging
