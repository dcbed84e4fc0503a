#pragma once
/// \file
/// One engine for each beacon address, made when its first event arrives, with its events put in order.

#include <sonopose/config/fusion_config.hpp>
#include <sonopose/core/pose.hpp>
#include <sonopose/core/status.hpp>
#include <sonopose/fusion/engine.hpp>
#include <sonopose/fusion/lossless_sequencer.hpp>
#include <sonopose/fusion/sequencer.hpp>

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace sonopose::nodes {

/// Fed by one thread; no locks. `PoseSink` and `ReportSink` get what the engines make, at once.
class BeaconEngines {
public:
  /// `lossless`: wait for a missing event without end, rather than for a few milliseconds.
  BeaconEngines(config::FusionConfig config, bool lossless);

  /// Takes an event that arrived at `now_ns` (steady clock) and calls `on_pose(FusedPose&)` and
  /// `on_report(const FixReport&)` for what came of it, and of those that waited for it.
  template <class OnPose, class OnReport>
  void push(const Event& event, TimeNs now_ns, const OnPose& on_pose, const OnReport& on_report) {
    Beacon& beacon = beacon_of(address_of(event));
    const auto deliver = [&](const Event& next) {
      if (beacon.starts_over(next)) beacon.engine.reset();
      if (const auto* imu = std::get_if<ImuSample>(&next)) {
        if (auto pose = beacon.engine.on(*imu)) on_pose(*pose);
      } else if (const auto* fix = std::get_if<UltrasonicFix>(&next)) {
        on_report(beacon.engine.on(*fix));
      } else {
        beacon.engine.on(std::get<PairHeading>(next));
      }
    };
    if (lossless_) {
      beacon.lossless_sequencer.push(event, deliver);
    } else {
      beacon.sequencer.push(event, now_ns, deliver);
    }
  }

  /// Re-initialises one beacon's engine, or every one's for all_beacons.
  void reset(BeaconAddress address);

  /// What one beacon's engine has counted; empty for an address never heard of.
  [[nodiscard]] std::optional<FusionStatus> status(BeaconAddress address) const;

  /// Every address heard of.
  [[nodiscard]] std::vector<BeaconAddress> addresses() const;

private:
  struct Beacon {
    explicit Beacon(const fusion::Settings& settings) : engine(settings) {}

    /// A bridge that was started anew and plays older times: nothing of the old state holds.
    bool starts_over(const Event& event);

    fusion::Engine engine;
    fusion::Sequencer sequencer;
    fusion::LosslessSequencer lossless_sequencer;
    std::uint64_t restarts_seen = 0;
  };

  Beacon& beacon_of(BeaconAddress address);

  config::FusionConfig config_;
  bool lossless_;
  std::unordered_map<BeaconAddress, std::unique_ptr<Beacon>> beacons_;
};

}  // namespace sonopose::nodes
