#pragma once
/// \file
/// Lets recorded or simulated time pass at a rate of real time.

#include "bridge/source.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/samples/samples.hpp>

namespace sonopose::bridge {

class Pacer {
public:
  /// `rate`: 1 is real time, 10 ten times as fast, 0 as fast as it can be. Throws std::invalid_argument for a
  /// negative or not finite one.
  explicit Pacer(double rate);

  /// Sleeps until `time_ns` of the recording is due, counted from the first call; flushes `sink` before
  /// it sleeps and ticks it meanwhile.
  /// Returns false when the stop came.
  bool wait_for(TimeNs time_ns, SampleSink& sink, const process::StopSignal& stop);

private:
  double rate_;
  bool begun_ = false;
  TimeNs first_ns_ = 0;
  SteadyTime began_;
  SteadyTime ticked_;
};

}  // namespace sonopose::bridge
