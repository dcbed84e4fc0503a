#pragma once
/// \file
/// A child process of the test: start, read output, signal, wait. The destructor always ends it.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace sonopose::test {

/// Upper bound of every wait, which otherwise ends with its event; reached only by a failing test.
inline constexpr std::chrono::milliseconds timeout{180'000};

/// Variables added to the environment of the test; an empty value removes one.
using Environment = std::map<std::string, std::string>;

/// A child process that its destruction kills.
class ChildProcess {
public:
  ChildProcess() = default;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  /// Runs a program after `attach`, which sets its standard streams and may only make async-signal-safe
  /// calls. Throws std::system_error.
  void start(std::vector<std::string> command, const Environment& environment,
             const std::function<void()>& attach);
  void send(int signal) const;
  std::optional<int> wait_for_exit(std::chrono::milliseconds limit = timeout);
  /// Kills it if it still runs.
  void kill();
  [[nodiscard]] int pid() const { return pid_; }

private:
  int pid_ = -1;
  int file_ = -1;
  std::optional<int> code_;
};

class Process {
public:
  enum class Stream : std::uint8_t { output, error };

  /// Starts the program. Throws std::system_error if that fails.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          const Environment& environment = {});
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// Kills the process if it still runs, and reaps it.
  ~Process();

  /// Waits until a complete line of `stream` contains `text`, including earlier lines. Returns false if the
  /// stream ends or the limit expires first.
  bool wait_for_line(Stream stream, std::string_view text, std::chrono::milliseconds limit = timeout);

  /// Waits until `stream` has this many lines.
  bool wait_for_lines(Stream stream, std::size_t count, std::chrono::milliseconds limit = timeout);

  /// Waits for the exit. Returns the exit code, or minus the signal that killed it; empty after the limit.
  std::optional<int> wait_for_exit(std::chrono::milliseconds limit = timeout);

  /// Sends a signal like kill(2).
  void send(int signal) const { child_.send(signal); }

  /// Exit code after a signal, and the time until the exit.
  struct Ending {
    std::optional<int> code;
    std::chrono::milliseconds took;
  };
  Ending end_by(int signal);

  /// Complete lines received so far.
  [[nodiscard]] std::vector<std::string> lines(Stream stream) const;
  /// The same lines as one string.
  [[nodiscard]] std::string text(Stream stream) const;

  [[nodiscard]] int pid() const { return child_.pid(); }

private:
  /// An output stream; `file` is our end of the pipe.
  struct Pipe {
    int file = -1;
    std::string unfinished;
    std::vector<std::string> lines;
    bool ended = false;
  };

  void listen();
  void take_in(Pipe& pipe);
  [[nodiscard]] const Pipe& pipe(Stream stream) const { return stream == Stream::output ? output_ : error_; }

  ChildProcess child_;
  mutable std::mutex mutex_;
  std::condition_variable news_;
  Pipe output_;
  Pipe error_;
  std::thread listener_;
};

/// Result of a program that has exited.
struct Result {
  std::optional<int> code;
  std::string output;
  std::string error;
};
Result run(const std::filesystem::path& program, const std::vector<std::string>& arguments,
           const Environment& environment = {});

}  // namespace sonopose::test
