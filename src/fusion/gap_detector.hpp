#pragma once
/// \file
/// Detects a lossless fusion that waits for a lost event.

#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sonopose::fusion {

/// An event that was lost before the bridge discovered the fusion never arrives, and a lossless fusion waits
/// for it without a time limit. The user has to know. Updated about once a second.
class GapDetector {
public:
  /// A longer wait is not explained by a slow transport.
  static constexpr TimeNs timeout_ns = 5'000'000'000;

  /// What one beacon's events wait for at `now`. Returns a message for the user, once for
  /// each event that is waited for.
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
