#pragma once
/// \file
/// Notices where a lossless fusion waits in vain.

#include <sonopose/collation/lossless_collator.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sonopose::fusion {

/// Lossless, an event that was lost before the bridge knew of the fusion is waited for without end: the user
/// must be told. Asked about once a second.
class GapDetector {
public:
  /// So long a wait is no slow transport any more.
  static constexpr TimeNs timeout_ns = 5'000'000'000;

  /// What one beacon's events wait for at `now`. Returns what to tell the user, once for
  /// each event that is waited for.
  std::optional<std::string> on(BeaconAddress address,
                                const std::optional<collation::LosslessCollator::Gap>& gap, SteadyTime now);

  /// Events were not taken for a while because a consumer was waited for: that wait does not count.
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
