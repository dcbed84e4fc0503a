#pragma once
/// \file
/// The log of a process on standard error, and for listeners. Only this folder includes the headers of
/// spdlog, since they are heavy.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::logging {

enum class Level : std::uint8_t {
  debug,
  info,
  warning,
  error,
  failure  ///< the reason why the process ends
};

/// Sets the name that begins each line, such as "sonopose-fusion". Call it before there are other threads.
void set_program(std::string name);

/// Returns that name, or the file name of the program.
const std::string& program();

/// The running log. One thread passes the lines to the listeners, another one writes them. A slow or stopped
/// reader of standard error therefore delays no other thread and no listener. One at a time.
class Session {
public:
  /// Lines that may wait for either thread. Newer lines replace the oldest.
  static constexpr std::size_t default_capacity = 2048;

  /// Lines of the same kind in a minute.
  enum class Repetition : std::uint8_t {
    limited,  ///< some are logged, the others counted
    unlimited
  };

  /// Drops lines below `min_level` without counting them. `capacity`: lines that may wait for standard error.
  /// Throws std::runtime_error if no thread can be created.
  explicit Session(Level min_level, std::size_t capacity = default_capacity,
                   Repetition repetition = Repetition::limited);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  /// Writes the waiting lines. Gives up after a second in which standard error took none.
  ~Session();

  /// Number of lines dropped by the full queue. The log also reports them, as soon as it can be written
  /// again.
  [[nodiscard]] std::size_t dropped() const;
};

struct Line {
  Level level = Level::info;
  std::int64_t time_ns = 0;  ///< time of logging, since the Unix epoch
  std::string_view text;     ///< text, valid during the call that passes it
};

/// Receives the lines of the session.
class Listener {
public:
  Listener() = default;
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  virtual ~Listener() = default;

  /// Called on the thread of the log, before the line is on standard error. It must not log, which would
  /// never end, and must not wait, since later lines wait for it.
  virtual void on(const Line& line) noexcept = 0;
};

/// Registers a listener. Its first line comes with the earlier ones of the session, at most the latest
/// `max_earlier`. Several at a time.
class Listening {
public:
  static constexpr std::size_t max_earlier = 64;

  explicit Listening(Listener& listener);
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
  /// Waits for a call in progress.
  ~Listening();

private:
  Listener& listener_;
};

/// Logs a text. With a session the line waits for its thread; without one it is written immediately.
/// Thread-safe; never throws. Allocates: do not call it between the arrival of a sample and its pose.
void write(Level level, std::string_view text) noexcept;

inline void debug(std::string_view text) noexcept {
  write(Level::debug, text);
}
inline void info(std::string_view text) noexcept {
  write(Level::info, text);
}
inline void warning(std::string_view text) noexcept {
  write(Level::warning, text);
}
inline void error(std::string_view text) noexcept {
  write(Level::error, text);
}

/// Logs how many lines a limit has left out in a minute that is over. Call it about once a second, so that
/// this does not wait for another line.
void report_left_out() noexcept;

/// Logs why the process ends, after the waiting lines. Returns when it is written or after a second.
void failure(std::string_view text) noexcept;

}  // namespace sonopose::logging
