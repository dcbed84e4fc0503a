#pragma once
/// \file
/// Detects a stream without samples on the reader's side. DDS alone does not detect a writer that is alive
/// and keeps its ownership but no longer writes one of its beacons.

#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::process {

/// The silence of one stream of one beacon. Not thread-safe.
class Silence {
public:
  void on_sample(SteadyTime now) { latest_ = now; }

  struct Change {
    bool silent = false;
    double lasted_s = 0;  ///< how long the silence has lasted, or lasted until the next sample
  };
  /// Returns whether the stream fell silent or resumed since the last call. It is silent without a sample for
  /// longer than `deadline_ns`, never before its first sample.
  std::optional<Change> find_change(SteadyTime now, TimeNs deadline_ns);

  /// Whether find_change would return a change.
  [[nodiscard]] bool has_changed(SteadyTime now, TimeNs deadline_ns) const {
    return latest_ && (now - *latest_ > deadline_ns) != silent_;
  }

  [[nodiscard]] bool is_silent() const { return silent_; }

private:
  std::optional<SteadyTime> latest_;
  bool silent_ = false;
  SteadyTime silent_since_;
};

}  // namespace sonopose::process
