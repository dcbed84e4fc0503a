#pragma once
/// \file
/// The interfaces between a bridge and its input.

#include "process/stop_signal.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

namespace sonopose::bridge {

/// Receives the output of a source.
class SampleSink {
public:
  SampleSink() = default;
  SampleSink(const SampleSink&) = delete;
  SampleSink& operator=(const SampleSink&) = delete;
  virtual ~SampleSink() = default;

  /// A sample. The sink numbers it if its sequence number is 0.
  virtual void on(const Event& event) = 0;

  /// The true state, from a source that knows it.
  virtual void on(const TruthSample& truth) = 0;

  /// What the source knows about a beacon; the sink fills in rates and other bridges.
  virtual void on(const BeaconStatus& status) = 0;

  /// A stationary beacon of the map, each time that the hardware sends it.
  virtual void on_stationary(const StationaryBeacon& /*beacon*/) {}

  /// Nothing comes from this beacon any more: the sink ends its streams until it returns. Only live lines say
  /// so, because a recording may contain any silence.
  virtual void on_gone(BeaconAddress /*address*/) {}

  /// The state and counters of the source's line; the sink fills in `bridge_id` and the time.
  virtual void on(const LineStatus& status) = 0;

  /// No more samples are due now: the sink may send what it has collected. `tick` does the same.
  virtual void flush() {}

  /// Called several times a second, also while there are no samples.
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

  /// Waits at the end until a capture is written. Throws files::IoError if bytes are missing in it.
  virtual void finish() {}

  /// Whether the samples exist already, so that none may be published before readers have joined.
  [[nodiscard]] virtual bool is_recording() const { return false; }
};

}  // namespace sonopose::bridge
