#pragma once
/// \file
/// Interfaces between a bridge and its input.

#include "process/stop_signal.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

namespace sonopose::publication {

/// Receives the output of a source.
class SampleSink {
public:
  SampleSink() = default;
  SampleSink(const SampleSink&) = delete;
  SampleSink& operator=(const SampleSink&) = delete;
  virtual ~SampleSink() = default;

  /// Takes a sample. The sink numbers it if its sequence number is 0.
  virtual void on(const Event& event) = 0;

  /// Takes the true state, from a source that knows it.
  virtual void on(const TruthSample& truth) = 0;

  /// Takes the source's status of a beacon; the sink fills in rates and other bridges.
  virtual void on(const BeaconStatus& status) = 0;

  /// Takes a stationary beacon of the map, each time that the hardware sends it.
  virtual void on_stationary(const StationaryBeacon& /*beacon*/) {}

  /// Ends the streams of a beacon until it returns. Only live lines call it, because a recording may contain
  /// any silence.
  virtual void on_gone(BeaconAddress /*address*/) {}

  /// Takes state and counters of the source's line; the sink fills in `bridge_id` and the time.
  virtual void on(const LineStatus& status) = 0;

  /// Announces that no more samples are due: the sink may send its collected samples. `tick` does the same.
  virtual void flush() {}

  /// Called several times a second, with or without samples.
  virtual void tick() = 0;
};

/// One input of a bridge.
class Source {
public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  /// Passes samples to `sink` until the input ends or the stop is requested, which it notices within a
  /// quarter of a second. Throws if the input becomes unusable.
  virtual void run(SampleSink& sink, const process::StopSignal& stop) = 0;

  /// Waits until a capture is written. Throws files::IoError if bytes are missing from it. Called at the end.
  virtual void finish() {}

  /// True if the samples exist already, so that publishing must wait for readers.
  [[nodiscard]] virtual bool is_recording() const { return false; }
};

}  // namespace sonopose::publication
