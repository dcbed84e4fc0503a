#pragma once
/// \file
/// Where a bridge gets its samples from, and where they go.

#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include "process/stop_signal.hpp"

namespace sonopose::bridge {

/// Takes what a source brings.
class SampleSink {
public:
  SampleSink() = default;
  SampleSink(const SampleSink&) = delete;
  SampleSink& operator=(const SampleSink&) = delete;
  virtual ~SampleSink() = default;

  /// A sample. Sequence number 0: the sink numbers it.
  virtual void on(const Event& event) = 0;

  /// The true state, where the source knows it.
  virtual void on(const TruthSample& truth) = 0;

  /// What the source knows of a beacon and its line; rates and other bridges are filled in by the sink.
  virtual void on(const BeaconStatus& status) = 0;

  /// Nothing more comes at this moment: what was brought may go on its way. At each `tick` it does so too.
  virtual void flush() {}

  /// To be called several times a second, also while there is nothing to bring.
  virtual void tick() = 0;
};

/// One input of a bridge.
class Source {
public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  /// Brings samples to `sink` until the input ends or the stop comes, which it notices within a quarter of a
  /// second. Throws what makes the input unusable.
  virtual void run(SampleSink& sink, const process::StopSignal& stop) = 0;

  /// Whether all of it is there from the start, so that nothing may be published before somebody listens.
  [[nodiscard]] virtual bool is_recording() const { return false; }
};

}  // namespace sonopose::bridge
