#pragma once
/// \file
/// The latest samples of each beacon, and the JSON that the page gets of them.

#include "observation/bus/bus_watch.hpp"
#include "threads/mutex.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace sonopose::web::live {

/// The latest samples of each beacon. Thread-safe.
class LiveState final : public observation::bus::SampleHook {
public:
  using SampleHook::on;
  void on(const FusedPose& pose) noexcept override;
  void on(const TruthSample& truth) noexcept override;
  void on(const FixReport& report) noexcept override;

  /// Returns new samples since the last call as JSON, without a newline; empty if there are none:
  /// {"op": "frame", "t", "beacons": [{"a", "pose": [...], "truth": [...], "fixes": [[...]]}]}.
  /// page_messages.hpp describes the fields.
  std::string take_frame(TimeNs now_ns);

  /// Latest pose and truth of each beacon in the same form, for a new page.
  [[nodiscard]] std::string latest(TimeNs now_ns) const;

  void forget(BeaconAddress address);

private:
  /// Most fixes to keep between two frames, the newest: a screen shows no more.
  static constexpr std::size_t max_fixes = 32;

  struct Beacon {
    FusedPose pose;
    TruthSample truth;
    std::vector<FixReport> fixes;
    bool has_pose = false;  ///< a new pose has arrived
    bool has_truth = false;
  };

  mutable threads::Mutex mutex_;
  std::map<BeaconAddress, Beacon> beacons_ SONOPOSE_GUARDED_BY(mutex_);
};

}  // namespace sonopose::web::live
