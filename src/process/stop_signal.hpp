#pragma once
/// \file
/// A request to end the process, from Ctrl-C, SIGTERM or the program itself.

#include <sonopose/samples/samples.hpp>

namespace sonopose::process {

/// At most one per process listens to signals; others, as in tests, are requested by hand.
class StopSignal {
public:
  StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;
  ~StopSignal();

  /// From now on SIGINT and SIGTERM request the stop. Throws std::system_error.
  void listen_to_signals();

  void request() noexcept;
  [[nodiscard]] bool requested() const noexcept;

  /// Sleeps until `deadline`, or until the stop. Returns whether the stop came.
  bool wait_until(SteadyTime deadline) const;

private:
  int event_fd_;
};

}  // namespace sonopose::process
