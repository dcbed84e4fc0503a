#pragma once
/// \file
/// "Please end": set by Ctrl-C, by SIGTERM, or by the program itself, and waited on by whoever has time.

#include <sonopose/samples/samples.hpp>

namespace sonopose::process {

/// One per process that listens to signals; further ones, as tests use them, are set by hand alone.
class StopSignal {
public:
  StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;
  ~StopSignal();

  /// From now on SIGINT and SIGTERM set this. Throws std::system_error.
  void listen_to_signals();

  void request() noexcept;
  [[nodiscard]] bool requested() const noexcept;

  /// Sleeps until `deadline`, or until the stop. Returns whether the stop came.
  bool wait_until(SteadyTime deadline) const;

private:
  int event_fd_;
};

}  // namespace sonopose::process
