#pragma once
/// \file
/// What the page shows of each beacon between two seconds, and its text.

#include "observation/bus/bus_watch.hpp"
#include "transitions/pose_watch.hpp"
#include "transitions/transition.hpp"

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::web::live {

/// The latest samples of each beacon. Thread-safe.
class LiveState final : public observation::bus::SampleHook {
public:
  using SampleHook::on;
  void on(const FusedPose& pose) noexcept override;
  void on(const TruthSample& truth) noexcept override;
  void on(const FixReport& report) noexcept override;

  /// What is new since the last call as JSON, without a newline; empty if nothing is. {"op": "frame", "t",
  /// "beacons": [{"a", "pose": [...], "truth": [...], "fixes": [[...]]}]}: docs/web.md describes the fields.
  std::string take_frame(TimeNs now_ns);

  /// The latest pose and truth of each beacon in the same form, for a new page.
  [[nodiscard]] std::string latest(TimeNs now_ns) const;

  /// The changes of state since the last call, by beacon.
  std::vector<std::pair<BeaconAddress, transitions::Pending>> take_transitions();

  void forget(BeaconAddress address);

private:
  /// Fixes that are kept between two frames, the newest ones: a screen shows no more.
  static constexpr std::size_t max_fixes = 32;

  struct Beacon {
    explicit Beacon(BeaconAddress address) noexcept : watch(address) {}

    FusedPose pose;
    TruthSample truth;
    std::vector<FixReport> fixes;
    bool has_pose = false;  ///< a new one
    bool has_truth = false;
    transitions::PoseWatch watch;
    transitions::Pending pending;
  };

  Beacon& beacon(BeaconAddress address);

  mutable std::mutex mutex_;  ///< guards the rest
  std::map<BeaconAddress, Beacon> beacons_;
};

}  // namespace sonopose::web::live
