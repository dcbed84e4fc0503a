#pragma once
/// \file
/// Keys that control a player from a terminal.

#include "process/stop_signal.hpp"

#include <atomic>
#include <cstdint>
#include <stop_token>
#include <thread>

namespace sonopose::player {

/// Requests of the user. Set by any thread.
class PlayControl {
public:
  void toggle_pause() noexcept {
    ++pause_toggles_;
    wakeup_.wake();
  }
  void step() noexcept {
    ++steps_;
    wakeup_.wake();
  }

  /// Number of toggles since the last call, for the playing thread.
  std::uint32_t take_pause_toggles() noexcept { return pause_toggles_.exchange(0); }
  /// Takes one requested step. Returns false if there is none.
  bool take_step() noexcept {
    if (steps_ == 0) return false;
    --steps_;
    return true;
  }
  /// Drops the steps that were requested without a pause.
  void forget_steps() noexcept { steps_ = 0; }

  /// Wakes the playing thread.
  process::Wakeup& wakeup() { return wakeup_; }

private:
  std::atomic<std::uint32_t> pause_toggles_ = 0;
  std::atomic<std::uint32_t> steps_ = 0;
  process::Wakeup wakeup_;
};

/// Reads single keys from standard input, if it is a terminal: the space bar pauses, `s` or `.` steps, `q`
/// stops.
class Keys {
public:
  /// The references must outlive it.
  Keys(PlayControl& control, process::StopSignal& stop);
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  /// Restores the line mode of the terminal.
  ~Keys();

  /// True if keys are read: there is a terminal.
  [[nodiscard]] bool are_read() const { return thread_.joinable(); }

private:
  void serve(const std::stop_token& end);

  PlayControl& control_;
  process::StopSignal& stop_;
  std::jthread thread_;
};

}  // namespace sonopose::player
