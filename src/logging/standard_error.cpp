#include "logging/standard_error.hpp"

#include "logging/line_format.hpp"
#include "logging/spdlog_level.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <poll.h>
#include <pthread.h>
#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <string>
#include <unistd.h>

namespace sonopose::logging {
namespace {

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

std::string line_of(Level level, std::string_view text) {
  static const Stream stream = stream_of(STDERR_FILENO, std::getenv("JOURNAL_STREAM"));
  return formatted(stream, program(), level, text);
}

}  // namespace

/// write(2) may block only after poll(2): a pipe that is ready takes a line of up to 4096 bytes.
void PatientWriter::write(std::string_view text) {
  const WithoutSigpipe guard;
  while (!text.empty()) {
    if (!is_ready()) return;
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno != EINTR && errno != EAGAIN) return;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
}

bool PatientWriter::is_ready() {
  constexpr std::chrono::milliseconds step{100};
  for (std::chrono::milliseconds waited{0}; !gave_up_; waited += step) {
    pollfd event{STDERR_FILENO, POLLOUT, 0};
    const int ready = ::poll(&event, 1, static_cast<int>(step.count()));
    if (ready > 0) return true;
    if (ready == 0 && ending_ && waited >= patience) gave_up_ = true;
  }
  return false;
}

void write_at_once(Level level, std::string_view text) {
  PatientWriter error;
  error.end();
  error.write(line_of(level, text));
}

/// Writes each line before it reads the next: nothing is lost in a buffer.
class StandardError::Sink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
public:
  /// `pool`: whose dropped lines it reports. It joins the thread that calls this sink, so it outlives all
  /// calls.
  Sink(spdlog::details::thread_pool& pool, Flushes& flushes) : pool_(pool), flushes_(flushes) {}

  void end() { writer_.end(); }

protected:
  void sink_it_(const spdlog::details::log_msg& line) override {
    report_dropped();
    writer_.write(line_of(level_of(line.level), {line.payload.data(), line.payload.size()}));
  }

  void flush_() override {
    report_dropped();
    const std::lock_guard lock(flushes_.mutex);
    ++flushes_.count;
    flushes_.changed.notify_all();
  }

private:
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
  PatientWriter writer_;
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
  wait_for_flush([this] { flush(); });
}

void StandardError::write(Level level, std::string_view text) {
  logger_->log(spdlog_level(level), spdlog::string_view_t(text.data(), text.size()));
}

std::size_t StandardError::dropped() const {
  return pool_->overrun_counter();
}

void StandardError::flush() {
  logger_->flush();
}

}  // namespace sonopose::logging
