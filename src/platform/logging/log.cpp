#include "logging/log.hpp"

#include "logging/later.hpp"
#include "logging/line_limit.hpp"
#include "logging/listeners.hpp"
#include "logging/spdlog_entry.hpp"
#include "logging/standard_error.hpp"
#include "logging/waiting_calls.hpp"
#include "threads/mutex.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <chrono>
#include <deque>
#include <memory>
#include <pthread.h>
#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <utility>
#include <vector>

namespace sonopose::logging {
namespace {

using spdlog::details::thread_pool;

/// Set once, before there are other threads.
std::string& program_name() {
  static std::string name = ::program_invocation_short_name;
  return name;
}

/// The limits of a session, for all threads.
class Limits {
public:
  explicit Limits(Session::Repetition repetition) : repetition_(repetition) {}

  /// Returns the lines to log now.
  std::vector<LineLimit::Admitted> admitted(Level level, std::string_view text) {
    if (repetition_ == Session::Repetition::unlimited) return {{level, std::string(text)}};
    const threads::Lock lock(mutex_);
    return limit_.admitted(level, text, std::chrono::steady_clock::now());
  }

  std::vector<LineLimit::Admitted> due() {
    const threads::Lock lock(mutex_);
    return limit_.due(std::chrono::steady_clock::now());
  }

  std::vector<LineLimit::Admitted> finish() {
    const threads::Lock lock(mutex_);
    return limit_.finish();
  }

private:
  Session::Repetition repetition_;
  threads::Mutex mutex_;
  LineLimit limit_ SONOPOSE_GUARDED_BY(mutex_);
};

/// Works on the thread of the session. Makes waiting calls, passes lines to the listeners, and leaves them to
/// standard error.
class Distributor final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
public:
  /// `pool`: source of dropped entries. It joins the thread that calls this sink, so it outlives all calls.
  Distributor(Level min_level, thread_pool& pool, StandardError& error, Limits& limits)
      : min_(min_level), pool_(pool), error_(error), limits_(limits) {}

  /// The waiting calls. Each is made when the mark with its number is read.
  WaitingCalls& waiting() { return waiting_; }

  /// Returns the distributor of this thread; null on any other thread.
  static Distributor* of_this_thread() { return on_this_thread; }

  /// Writes a line of the session's own thread directly after the previous ones.
  void write_own(Level level, std::string_view text) {
    if (level < min_) return;
    for (const auto& line : limits_.admitted(level, text)) write(line.level, line.text);
  }

  /// Does the same with the reports that are due.
  void write_due() {
    for (const auto& line : limits_.due()) write(line.level, line.text);
  }

  /// Waits until the lines of the session's own thread are written; gives up after `write_timeout`.
  void flush_own() {
    const auto number = error_.next_flush();
    error_.flush(number);
    error_.wait_for_flush(number);
  }

protected:
  void sink_it_(const spdlog::details::log_msg& entry) override {
    time_ns_ = std::chrono::duration_cast<std::chrono::nanoseconds>(entry.time.time_since_epoch()).count();
    on_this_thread = this;
    report_dropped();
    if (is_mark(entry.source, call_mark)) {
      make_calls(number_of(entry.source));
    } else if (is_mark(entry.source, flush_mark)) {
      error_.flush(number_of(entry.source));
    } else {
      write(level_of(entry.level), {entry.payload.data(), entry.payload.size()});
    }
  }

  void flush_() override {}

private:
  void report_dropped() {
    const std::size_t dropped = pool_.overrun_counter();
    if (dropped == reported_) return;
    report(dropped - std::exchange(reported_, dropped), "line of this log was", "lines of this log were");
    make_calls(waiting_.latest());  // includes calls whose marks were dropped
  }

  void make_calls(WaitingCalls::Number last) {
    report(waiting_.make_up_to(last), "change was", "changes were");
  }

  void report(std::size_t lost, std::string_view one, std::string_view several) {
    if (lost == 0) return;
    write(Level::warning,
          fmt::format("{} not logged: too many at a time", text::count_text(lost, one, several)));
  }

  void write(Level level, std::string_view text) {
    if (is_passing_on_) return error_.write(level, text);  // DDS logs what a listener has caused
    is_passing_on_ = true;
    listeners().pass_on({level, time_ns_, text}, earlier_);
    is_passing_on_ = false;
    error_.write(level, text);
    if (earlier_.size() == Listening::max_earlier) earlier_.pop_front();
    earlier_.push_back({level, time_ns_, std::string(text)});
  }

  static thread_local Distributor* on_this_thread;

  Level min_;
  thread_pool& pool_;
  StandardError& error_;
  Limits& limits_;
  WaitingCalls waiting_;
  bool is_passing_on_ = false;
  std::size_t reported_ = 0;
  std::int64_t time_ns_ = 0;  ///< time of the latest line or call
  std::deque<KeptLine> earlier_;
};

thread_local Distributor* Distributor::on_this_thread = nullptr;

/// The state of a session, shared so that a line in progress keeps it alive.
struct SessionState {
  SessionState(Level min_level, std::size_t capacity, Session::Repetition repetition)
      : error(capacity),
        limits(repetition),
        pool(std::make_shared<thread_pool>(Session::default_capacity, 1,
                                           [] { ::pthread_setname_np(::pthread_self(), "log"); })),
        distributor(std::make_shared<Distributor>(min_level, *pool, error, limits)),
        logger(std::make_shared<spdlog::async_logger>("", distributor, pool,
                                                      spdlog::async_overflow_policy::overrun_oldest)) {
    logger->set_level(spdlog_level(min_level));
  }
  SessionState(const SessionState&) = delete;
  SessionState& operator=(const SessionState&) = delete;
  /// Joins the thread before what it uses ends.
  ~SessionState() {
    finish();
    logger.reset();
    pool.reset();
  }

  /// Logs a line, unless it is below the level or over a limit.
  void write(Level level, std::string_view text) {
    if (!logger->should_log(spdlog_level(level))) return;
    for (const auto& line : limits.admitted(level, text)) log(line);
  }

  void write_due() {
    for (const auto& line : limits.due()) log(line);
  }

  /// Logs how many lines were left out.
  void finish() noexcept {
    try {
      for (const auto& line : limits.finish()) log(line);
    } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for the lines
    }
  }

  void log(const LineLimit::Admitted& line) {
    logger->log(spdlog_level(line.level), spdlog::string_view_t(line.text.data(), line.text.size()));
  }

  /// Waits until all earlier lines are written; gives up after `write_timeout`. For threads other than that
  /// of the session.
  void flush() {
    const auto number = error.next_flush();
    logger->log(mark(flush_mark, number), spdlog::level::critical, spdlog::string_view_t());
    error.wait_for_flush(number);
  }

  StandardError error;  ///< first member, so that it ends last
  Limits limits;
  std::shared_ptr<thread_pool> pool;
  std::shared_ptr<Distributor> distributor;
  std::shared_ptr<spdlog::async_logger> logger;
};

threads::Mutex session_mutex;
std::shared_ptr<SessionState> session SONOPOSE_GUARDED_BY(session_mutex);  // null without one

std::shared_ptr<SessionState> current() {
  const threads::Lock lock(session_mutex);
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

Session::Session(Level min_level, std::size_t capacity, Repetition repetition) {
  auto state = std::make_shared<SessionState>(min_level, capacity, repetition);
  const threads::Lock lock(session_mutex);
  session = std::move(state);
}

/// Each thread pool writes its queued lines before it ends. The lock is released first, since a call may log.
Session::~Session() {
  std::shared_ptr<SessionState> state;
  {
    const threads::Lock lock(session_mutex);
    state.swap(session);
  }
}

std::size_t Session::dropped() const {
  const auto state = current();
  return state ? state->pool->overrun_counter() + state->error.dropped() : 0;
}

void write(Level level, std::string_view text) noexcept {
  try {
    if (Distributor* const distributor = Distributor::of_this_thread()) {
      distributor->write_own(level, text);
    } else if (const auto state = current()) {
      state->write(level, text);
    } else {
      write_at_once(level, text);
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for the line
  }
}

void later(std::function<void()> log) noexcept {
  try {
    if (Distributor::of_this_thread() != nullptr) return log();
    const auto state = current();
    if (!state) return log();
    if (const auto number = state->distributor->waiting().add(std::move(log))) {
      state->logger->log(mark(call_mark, *number), spdlog::level::critical, spdlog::string_view_t());
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for the line
  }
}

void report_left_out() noexcept {
  try {
    if (Distributor* const distributor = Distributor::of_this_thread()) {
      distributor->write_due();
    } else if (const auto state = current()) {
      state->write_due();
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for the lines
  }
}

void failure(std::string_view text) noexcept {
  write(Level::failure, text);
  try {
    if (Distributor* const distributor = Distributor::of_this_thread()) return distributor->flush_own();
    if (const auto state = current()) state->flush();
  } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory to wait with
  }
}

}  // namespace sonopose::logging
