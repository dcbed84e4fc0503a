#pragma once
/// \file
/// Memory of how long wrong tracks last.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::kalman {

/// Longest duration of a wrong track, which decays exponentially. The wait for another track is proportional
/// to it and bounded, so that a long track keeps the wait at its maximum for longer.
struct WrongTracks {
  double longest_s = 0;  ///< longest duration, as of `seen_ns`
  TimeNs seen_ns = 0;

  void add(double duration_s, TimeNs now_ns);
  /// Duration that makes the next track credible.
  [[nodiscard]] double wait_s(TimeNs now_ns) const;
  bool operator==(const WrongTracks&) const = default;

private:
  [[nodiscard]] double faded_s(TimeNs now_ns) const;
};

void for_each_field(IsFieldsOf<WrongTracks> auto& tracks, const auto& visit) {
  visit("longest_s", tracks.longest_s);
  visit("seen_ns", tracks.seen_ns);
}

}  // namespace sonopose::estimation::kalman
