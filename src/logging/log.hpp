#pragma once
/// \file
/// The log of a process on standard error, and for listeners. The headers of spdlog are included in this
/// folder alone, since they are heavy.

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

/// Sets the name that begins each line of text, as "sonopose-fusion". Call it before there are other threads.
void set_program(std::string name);

/// That name, or the file name of the program.
const std::string& program();

/// While it exists, one thread passes the lines on to the listeners and another one writes them, so that a
/// slow or stopped reader of standard error delays no other thread and no listener. One at a time.
class Session {
public:
  /// Lines that may wait for either thread; the oldest are dropped for newer ones.
  static constexpr std::size_t default_capacity = 2048;

  /// Lines below `least` are dropped without being counted. `capacity`: lines that may wait for standard
  /// error. Throws std::runtime_error if there is no thread.
  explicit Session(Level least, std::size_t capacity = default_capacity);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  /// Writes the lines that wait. Gives up after a second in which standard error took none.
  ~Session();

  /// Lines dropped by the full queue. The log reports them too, as soon as it can be written again.
  [[nodiscard]] std::size_t dropped() const;
};

/// A line of a session.
struct Line {
  Level level = Level::info;
  std::int64_t time_ns = 0;  ///< when it was logged, since the Unix epoch
  std::string_view text;     ///< valid during the call that passes it
};

/// Receives the lines of the session.
class Listener {
public:
  Listener() = default;
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  virtual ~Listener() = default;

  /// On the thread of the log, before the line is on standard error. It must not log, since that would never
  /// end, and must not wait, since the lines that follow wait for it.
  virtual void on(const Line& line) noexcept = 0;
};

/// While it exists, the listener receives lines: together with the next one those that the session had
/// before, at most the latest `most_earlier`. Several at a time.
class Listening {
public:
  static constexpr std::size_t most_earlier = 64;

  explicit Listening(Listener& listener);
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
  /// Waits for a call that is in progress.
  ~Listening();

private:
  Listener& listener_;
};

/// Logs a text. With a session the line waits for its thread; without one it is written at once. Thread-safe;
/// never throws. Allocates: do not call it between the arrival of a sample and its pose.
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

/// Logs why the process ends, after the lines that wait, and returns when it is written or after a second.
void failure(std::string_view text) noexcept;

}  // namespace sonopose::logging
