#pragma once
/// \file
/// Detects that a lossless fusion waits for a lost event.

#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sonopose::fusion {

/// Waits of a lossless fusion. An event that was lost before the bridge discovered the fusion never arrives,
/// and the fusion waits for it indefinitely. The user has to know. Call `on` about once a second.
class GapDetector {
public:
  /// Limit beyond any delay of a slow transport.
  static constexpr TimeNs timeout_ns = 5'000'000'000;

  /// Takes the gap that one beacon's events wait for at `now`. Returns a message for the user, once for each
  /// missing event.
  std::optional<std::string> on(BeaconAddress address,
                                const std::optional<collation::LosslessCollator::Gap>& gap, SteadyTime now);

  /// Restarts all waits, because no events were taken while the fusion waited for a consumer.
  void start_over() { waits_.clear(); }

private:
  struct Wait {
    std::uint64_t missing = 0;
    SteadyTime since;
    bool reported = false;
  };
  std::map<BeaconAddress, Wait> waits_;
};

}  // namespace sonopose::fusion
