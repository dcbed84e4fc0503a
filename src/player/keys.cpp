#include "player/keys.hpp"

#include "process/sudden_end.hpp"

#include <atomic>
#include <poll.h>
#include <stop_token>
#include <termios.h>
#include <unistd.h>

namespace sonopose::player {

struct Keys::SavedMode {
  termios mode{};
};

namespace {

/// A program in the background would be stopped for a change of the terminal.
bool is_in_foreground() noexcept {
  return ::tcgetpgrp(STDIN_FILENO) == ::getpgrp();
}

/// For a signal handler; null while the terminal has its own mode.
std::atomic<const termios*> mode_to_restore{nullptr};
static_assert(std::atomic<const termios*>::is_always_lock_free);

void restore_mode() noexcept {
  const termios* const mode = mode_to_restore.load();
  if (mode != nullptr && is_in_foreground()) ::tcsetattr(STDIN_FILENO, TCSANOW, mode);
}

}  // namespace

Keys::Keys(PlayControl& control, process::StopSignal& stop) : control_(control), stop_(stop) {
  if (::isatty(STDIN_FILENO) == 0 || !is_in_foreground()) return;
  auto saved = std::make_unique<SavedMode>();
  if (::tcgetattr(STDIN_FILENO, &saved->mode) != 0) return;
  termios mode = saved->mode;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C still is a signal
  if (::tcsetattr(STDIN_FILENO, TCSANOW, &mode) != 0) return;
  saved_ = std::move(saved);
  mode_to_restore.store(&saved_->mode);
  process::set_sudden_end_call(restore_mode);
  thread_ = std::jthread([this](const std::stop_token& end) { serve(end); });
}

Keys::~Keys() {
  if (!saved_) return;
  thread_.request_stop();
  thread_.join();
  ::tcsetattr(STDIN_FILENO, TCSANOW, &saved_->mode);
  mode_to_restore.store(nullptr);
}

void Keys::serve(const std::stop_token& end) {
  constexpr int look_period_ms = 100;
  while (!end.stop_requested()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, look_period_ms) <= 0) continue;
    char key = 0;
    if (::read(STDIN_FILENO, &key, 1) != 1) return;  // the terminal is gone
    switch (key) {
      case ' ':
        control_.toggle_pause();
        break;
      case 's':
      case '.':
        control_.step();
        break;
      case 'q':
        stop_.request();
        control_.wakeup().wake();
        return;
      default:
        break;
    }
  }
}

}  // namespace sonopose::player
