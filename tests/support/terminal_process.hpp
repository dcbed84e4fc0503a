#pragma once
/// \file
/// A program on its own terminal: the test types, resizes and sees the screen.

#include "support/process.hpp"
#include "support/text_screen.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace sonopose::test {

class TerminalProcess {
public:
  /// Starts the program. Throws std::system_error.
  TerminalProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                  std::size_t columns = 80, std::size_t rows = 24,
                  Environment environment = {{"TERM", "xterm-256color"}});
  TerminalProcess(const TerminalProcess&) = delete;
  TerminalProcess& operator=(const TerminalProcess&) = delete;
  /// Kills the process if it still runs.
  ~TerminalProcess();

  /// Types on the keyboard; "\x03" is Ctrl-C.
  void type(std::string_view keys) const;
  void resize(std::size_t columns, std::size_t rows);
  void send(int signal) const { child_.send(signal); }
  [[nodiscard]] int pid() const { return child_.pid(); }

  /// Waits until `done(screen)`. Returns false after the limit.
  bool wait_until(const std::function<bool(const TextScreen&)>& done,
                  std::chrono::milliseconds limit = timeout);
  /// Waits until a row contains the text.
  bool wait_for(std::string_view text, std::chrono::milliseconds limit = timeout);

  /// Waits for the exit and the complete output. Returns the exit code, or minus the signal that killed it;
  /// empty after the limit.
  std::optional<int> wait_for_exit(std::chrono::milliseconds limit = timeout);

  [[nodiscard]] TextScreen screen() const;
  /// All bytes received so far.
  [[nodiscard]] std::string output() const;
  /// Returns true if the line echoes and is line-buffered, as before a full-screen program.
  [[nodiscard]] bool has_normal_line() const;

private:
  void listen();
  void take_in();

  int master_ = -1;
  int slave_ = -1;  ///< keeps the line open after the exit
  ChildProcess child_;
  mutable std::mutex mutex_;  // guards screen_ and output_
  std::condition_variable news_;
  TextScreen screen_;
  std::string output_;
  std::atomic<bool> ending_ = false;
  std::thread listener_;
};

}  // namespace sonopose::test
