#pragma once
/// \file
/// A request to end the process, from Ctrl-C, SIGTERM or the program itself, and what else wakes its threads.

#include <sonopose/samples/samples.hpp>

#include <atomic>

namespace sonopose::process {

/// Wakes a thread that sleeps in StopSignal::wait_until. An event before the sleep counts.
class Wakeup {
public:
  Wakeup();
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;
  ~Wakeup();

  /// Any thread may call this, also a listener of Cyclone DDS: it does not block.
  void wake() noexcept;

private:
  friend class StopSignal;

  int event_fd_;
};

/// Ends a sleep in StopSignal::wait_until at a time that another thread can move while it lasts.
class Alarm {
public:
  Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;
  ~Alarm();

  /// Replaces the time set before; one that has passed ends the sleep at once. Any thread may call this, one
  /// at a time, also a listener of Cyclone DDS: it does not block.
  void set(SteadyTime at) noexcept;

  /// The time that was set last.
  [[nodiscard]] SteadyTime at() const noexcept { return {at_ns_.load()}; }

private:
  friend class StopSignal;

  int timer_fd_;
  std::atomic<TimeNs> at_ns_ = 0;
};

/// At most one per process listens to signals; others, as in tests, are requested by hand.
class StopSignal {
public:
  StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;
  ~StopSignal();

  /// From now on SIGINT and SIGTERM request the stop. A second one, more than 1 s after the first, ends the
  /// process at once. Throws std::system_error.
  void listen_to_signals();

  void request() noexcept;
  [[nodiscard]] bool requested() const noexcept;

  /// Sleeps until `deadline`, or until the stop. Returns whether the stop came.
  bool wait_until(SteadyTime deadline) const;
  /// The same, but it also returns, once, after `wakeup`. One thread per wakeup.
  bool wait_until(SteadyTime deadline, Wakeup& wakeup) const;
  /// The same with an alarm.
  bool wait_until(SteadyTime deadline, Alarm& alarm) const;

private:
  bool wait_until(SteadyTime deadline, int other_fd) const;

  int event_fd_;
};

}  // namespace sonopose::process
