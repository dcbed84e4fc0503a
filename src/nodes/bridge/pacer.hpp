#pragma once
/// \file
/// Plays recorded or simulated time at a multiple of real time.

#include "process/stop_signal.hpp"
#include "publication/source.hpp"
#include <sonopose/samples/samples.hpp>

namespace sonopose::bridge {

/// Waits until recorded times are due.
class Pacer {
public:
  /// `rate`: 1 is real time, 10 is ten times as fast, 0 is as fast as possible. Throws std::invalid_argument
  /// if it is negative or not finite.
  explicit Pacer(double rate);

  /// Sleeps until `time_ns` of the recording is due, counted from the first call. Flushes `sink` before
  /// sleeping and ticks it meanwhile. Returns false once the stop is requested.
  bool wait_for(TimeNs time_ns, publication::SampleSink& sink, const process::StopSignal& stop);

  /// Lets `time_ns` be due now, as after a step of the recording's clock.
  void restart_at(TimeNs time_ns);

private:
  double rate_;
  bool begun_ = false;
  TimeNs first_ns_ = 0;
  SteadyTime began_;
  SteadyTime ticked_;
};

}  // namespace sonopose::bridge
