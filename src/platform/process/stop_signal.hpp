#pragma once
/// \file
/// A request to end the process, by a signal or the program itself, and other events that wake its threads.

#include "files/descriptor.hpp"
#include <sonopose/samples/samples.hpp>

#include <atomic>

namespace sonopose::process {

/// Wakes a thread that sleeps in StopSignal::wait_until. An event before the sleep counts.
class Wakeup {
public:
  Wakeup();

  /// Wakes the thread. Never blocks, so any thread may call it, even a listener of Cyclone DDS.
  void wake() noexcept;

private:
  friend class StopSignal;

  files::Descriptor event_;
};

/// Ends a sleep in StopSignal::wait_until at a time that another thread can change meanwhile.
class Alarm {
public:
  Alarm();

  /// Replaces the previous time; a past one ends the sleep immediately. Never blocks, so any thread may call
  /// it, even a listener of Cyclone DDS. One thread at a time.
  void set(SteadyTime at) noexcept;

  /// The latest time that was set.
  [[nodiscard]] SteadyTime at() const noexcept { return {at_ns_.load()}; }

private:
  friend class StopSignal;

  files::Descriptor timer_;
  std::atomic<TimeNs> at_ns_ = 0;
};

/// A stop request. At most one per process listens to signals; others, as in tests, are requested by hand.
class StopSignal {
public:
  StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;
  ~StopSignal();

  /// Makes SIGINT, SIGTERM, SIGHUP (a closed terminal; unless it is ignored, as by nohup) and SIGXCPU (out of
  /// processor time) request the stop from now on. A second SIGINT or SIGTERM, more than 1 s after the first,
  /// ends the process immediately. Throws std::system_error.
  void listen_to_signals();

  void request() noexcept;
  [[nodiscard]] bool requested() const noexcept;

  /// Sleeps until `deadline` or the stop. Returns true if the stop came.
  bool wait_until(SteadyTime deadline) const;
  /// Sleeps until `deadline`, the stop or, once, `wakeup`. Returns true if the stop came. One thread per
  /// wakeup.
  bool wait_until(SteadyTime deadline, Wakeup& wakeup) const;
  /// Sleeps until `deadline`, the stop or the alarm. Returns true if the stop came.
  bool wait_until(SteadyTime deadline, Alarm& alarm) const;

private:
  bool wait_until(SteadyTime deadline, int other_fd) const;

  files::Descriptor event_;
};

}  // namespace sonopose::process
