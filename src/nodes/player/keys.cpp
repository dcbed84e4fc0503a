#include "player/keys.hpp"

#include "process/emergency_cleanup.hpp"
#include "terminal/foreground.hpp"

#include <atomic>
#include <poll.h>
#include <stop_token>
#include <termios.h>
#include <unistd.h>

namespace sonopose::player {
namespace {

/// Static state: a signal handler on any thread may read it at any time.
termios own_mode{};
std::atomic<bool> must_restore{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void restore_mode() noexcept {
  if (must_restore && !terminal::is_in_background(STDIN_FILENO)) {
    ::tcsetattr(STDIN_FILENO, TCSANOW, &own_mode);
  }
}

}  // namespace

Keys::Keys(PlayControl& control, process::StopSignal& stop) : control_(control), stop_(stop) {
  // Keys of another terminal than the controlling one may be meant for a shell.
  const bool is_controlling = ::tcgetpgrp(STDIN_FILENO) >= 0;
  if (!is_controlling || terminal::is_in_background(STDIN_FILENO)) return;
  if (::tcgetattr(STDIN_FILENO, &own_mode) != 0) return;
  termios mode = own_mode;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C is still a signal
  // Start the thread first: a failure must leave the terminal unchanged.
  thread_ = std::jthread([this](const std::stop_token& end) { serve(end); });
  must_restore = true;
  process::set_emergency_cleanup(restore_mode);
  if (::tcsetattr(STDIN_FILENO, TCSANOW, &mode) == 0) return;
  must_restore = false;
  thread_ = {};
}

Keys::~Keys() {
  if (!are_read()) return;
  thread_.request_stop();
  thread_.join();
  ::tcsetattr(STDIN_FILENO, TCSANOW, &own_mode);
  must_restore = false;
}

void Keys::serve(const std::stop_token& end) {
  constexpr int poll_period_ms = 100;
  while (!end.stop_requested()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, poll_period_ms) <= 0) continue;
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
