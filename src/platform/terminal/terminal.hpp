#pragma once
/// \file
/// A full-screen text terminal, based on ncurses.

#include "terminal/crash_restore.hpp"
#include "terminal/error_lines.hpp"
#include "terminal/text.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::terminal {

/// Returns true if standard input and output are a terminal that can show a screen: TERM is set and is not
/// "dumb".
[[nodiscard]] bool is_screen();

/// The error for a terminal that cannot show a screen.
class NoScreen : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The terminal in full-screen mode during its lifetime. The destructor and a crash restore it. Lines on
/// standard error wait for `messages`. One per process, used by one thread.
///
/// Uses colours if the terminal has them and NO_COLOR is not set.
class Terminal {
public:
  /// Throws NoScreen if the type of the terminal is unknown, and std::system_error.
  Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  /// Returns the next pressed key; does not wait.
  [[nodiscard]] std::optional<Key> key();

  [[nodiscard]] Size size() const;

  /// Shows these lines from the top, and cuts the rest.
  void draw(const std::vector<Row>& rows);

  /// Returns the lines that were written to standard error since the last call.
  std::vector<std::string> messages() { return errors_->take(); }

private:
  class Curses;

  std::unique_ptr<Curses> curses_;
  std::unique_ptr<ErrorLines> errors_;
  std::unique_ptr<CrashRestore> crash_restore_;
};

}  // namespace sonopose::terminal
