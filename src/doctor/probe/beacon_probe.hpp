#pragma once
/// \file
/// What the doctor collects of one beacon: told of each sample as it comes, and asked once at the end.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include "doctor/rules/doctor.hpp"

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace sonopose::doctor {

/// Samples before `begin` only tell of the numbering; all else is of the window. Times are this host's clock.
class BeaconProbe {
public:
  void on(const ImuSample& imu, TimeNs received_ns, std::uint64_t writer);
  void on(const UltrasonicFix& fix, TimeNs received_ns);
  void on(const PairHeading& heading, TimeNs received_ns);
  void on(const FusedPose& pose, TimeNs received_ns);
  void on(const BeaconStatus& status);
  void on(const FusionStatus& status);

  /// The window begins.
  void begin(TimeNs now_ns);

  /// The window is over. The processes behind `writers()`, the deadlines and the address are left open.
  [[nodiscard]] BeaconObservation seen(TimeNs now_ns, const calibration::Settings& calibration) const;

  /// Who publishes its IMU samples: the handles given to `on`.
  [[nodiscard]] const std::set<std::uint64_t>& writers() const { return writers_; }

private:
  /// Counts one stream.
  struct Stream {
    std::uint64_t samples = 0;
    TimeNs last_ns = 0;
    TimeNs longest_ns = 0;
    void count(TimeNs received_ns);
    [[nodiscard]] StreamObservation seen(TimeNs began_ns, TimeNs ended_ns) const;
  };

  void number(std::uint64_t sequence, TimeNs received_ns);
  [[nodiscard]] std::uint64_t missing(TimeNs ended_ns) const;
  [[nodiscard]] std::optional<RestObservation> means(const calibration::Settings& calibration) const;
  [[nodiscard]] bool in_window() const { return began_ns_ != 0; }

  TimeNs began_ns_ = 0;
  Stream imu_;
  Stream fix_;
  Stream heading_;
  Stream pose_;
  std::uint64_t valid_headings_ = 0;
  std::uint32_t lasting_status_ = 0xFFFFFFFF;
  std::set<std::uint64_t> writers_;
  std::vector<std::pair<std::uint64_t, TimeNs>> numbers_;  ///< event numbers and when they came
  std::uint64_t last_imu_number_ = 0;
  std::vector<double> ahead_s_;
  std::vector<std::pair<Vector3d, Vector3d>> readings_;  ///< specific force, angular velocity; as published
  Vector3d fixes_min_m_ = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d fixes_max_m_ = Vector3d::Constant(-std::numeric_limits<double>::infinity());
  std::optional<BeaconStatus> status_before_;
  std::optional<BeaconStatus> status_;
  struct FusionObservation {
    FusionStatus before;
    FusionStatus latest;
  };
  std::map<std::uint64_t, FusionObservation> fusions_;  ///< by their ids
};

/// The calibration of an engine's settings in force; what cannot be read is left at its default.
calibration::Settings calibration_in(const EffectiveSettings& settings);

}  // namespace sonopose::doctor
