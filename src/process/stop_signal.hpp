#pragma once
/// \file
/// A request to end the process, from Ctrl-C, SIGTERM or the program itself, and what else wakes its threads.

#include <sonopose/samples/samples.hpp>

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

private:
  int event_fd_;
};

}  // namespace sonopose::process
