#pragma once
/// \file
/// Detects on the reader's side that a stream has no samples. DDS does not detect a living writer that keeps
/// its ownership but no longer writes one of its beacons.

#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::presence {

/// Silence of one stream of one beacon. Not thread-safe.
class Silence {
public:
  void on_sample(SteadyTime now) { latest_ = now; }

  struct Change {
    bool silent = false;
    double lasted_s = 0;  ///< length of the silence, so far or until the next sample
  };
  /// Reports whether the stream fell silent or resumed since the last call; empty if neither. It is silent
  /// without a sample for longer than `deadline_ns`, but never before its first sample.
  std::optional<Change> find_change(SteadyTime now, TimeNs deadline_ns);

  /// True if find_change would return a change.
  [[nodiscard]] bool has_changed(SteadyTime now, TimeNs deadline_ns) const {
    return latest_ && (now - *latest_ > deadline_ns) != silent_;
  }

  [[nodiscard]] bool is_silent() const { return silent_; }

private:
  std::optional<SteadyTime> latest_;
  bool silent_ = false;
  SteadyTime silent_since_;
};

}  // namespace sonopose::presence
