#pragma once
/// \file
/// Observations of a running system, collected by doctor/probe: values without DDS entities, clocks or
/// threads.

#include "motion/fit/window_fit.hpp"
#include "motion/fix_faults.hpp"
#include "motion/imu_summary.hpp"
#include "motion/turn_gain.hpp"
#include "observation/pose_writers.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/dds/psm/qos.hpp>
#include <sonopose/estimation/aiding/height_check.hpp>
#include <sonopose/samples/fix_refusal.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::doctor::rules {

using ProcessObservation = observation::ProcessIdentity;

/// A reader or writer of another process.
struct EndpointObservation {
  std::string topic;
  std::string type;
  dds::Qos qos;
  ProcessObservation process;
};

/// The expected type of a native topic.
struct NativeTopic {
  std::string name;
  std::string type;
};

/// An interface named in the user's CYCLONEDDS_URI.
struct InterfaceObservation {
  std::string name;
  bool multicast = false;
  bool loopback = false;
};

/// Another domain of the same network with processes of this system.
struct DomainObservation {
  std::uint32_t id = 0;
  bool beacons = false;      ///< IMU samples are published
  bool poses = false;        ///< poses are published
  bool ours = false;         ///< there is an endpoint of any native topic
  bool on_loopback = false;  ///< the same domain, on loopback instead of the network
};

struct BusObservation {
  std::uint32_t domain_id = 0;
  bool loopback_only = true;        ///< no other machine can be discovered
  std::string interfaces_in_use;    ///< and why: "lo (127.0.0.1)", "eth0 (10.0.0.2), no other is up"
  bool is_network_missing = false;  ///< none is up, or none has a carrier
  std::vector<InterfaceObservation> interfaces;
  bool has_peers = false;             ///< CYCLONEDDS_URI names peers
  bool is_secured = false;            ///< DDS Security is in use
  std::vector<std::string> refused;   ///< one text for each process that it refused, with the reason
  std::size_t without_topics = 0;     ///< processes with hidden topics, as on a bus secured against this one
  std::vector<std::string> expiring;  ///< one text for each enclave of the key store that expires soon
  bool searched_other_domains = false;
  std::vector<DomainObservation> other_domains;
  std::size_t domains_not_searched = 0;  ///< skipped for lack of time or file descriptors
};

/// One stream of one beacon over the window.
struct StreamObservation {
  std::uint64_t samples = 0;
  double rate_hz = 0;
  double longest_silence_s = 0;  ///< including the one at the end of the window
  double deadline_s = std::numeric_limits<double>::infinity();  ///< deadline of the QoS profile
  std::uint64_t silences = 0;  ///< number of silences longer than the deadline
  double silent_s = 0;         ///< total length of these silences
};

/// Means of the IMU over the longest rest, in body axes, with the fusion's calibration applied.
struct RestObservation {
  Vector3d mean_force_body_mps2 = Vector3d::Zero();
  Vector3d mean_rate_body_radps = Vector3d::Zero();
  calibration::AxesSettings axes;
};

/// Number of poses in the window for each bit of PoseStatus that is no consequence of another.
class StatusCounts {
public:
  void add(std::uint32_t status) {
    ++poses_;
    for (std::size_t i = 0; i < bits_.size(); ++i) bits_.at(i) += (status >> i) & 1U;
  }
  /// Share of the poses that have this bit; 0 without poses.
  [[nodiscard]] double share_of(PoseStatus bit) const {
    const auto count = bits_.at(static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(bit))));
    return poses_ == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(poses_);
  }

private:
  std::uint64_t poses_ = 0;
  std::array<std::uint64_t, 32> bits_{};
};

/// Treatment of the fixes by the fusion in the last two minutes.
struct FixOutcomes {
  std::uint64_t reports = 0;
  std::array<std::uint64_t, fix_refusal_count> refused{};  ///< by cause (FixRefusal)
  std::vector<Vector3d> outliers_m;                        ///< innovations of the rejected outliers, world
  std::uint64_t relocations = 0;  ///< jumps of more than 0.3 m to other fixes, not after a freeze
  double longest_relocation_m = 0;
};

/// First and last status of one fusion in the window.
struct FusionSpan {
  FusionStatus before;
  FusionStatus latest;
};

/// One beacon over the window.
struct BeaconObservation {
  BeaconAddress address = 0;
  StreamObservation imu;
  StreamObservation fix;
  StreamObservation heading;
  StreamObservation pose;
  std::uint64_t pair_headings = 0;  ///< those of a pair, not of a compass or a pose
  std::uint64_t valid_pair_headings = 0;
  double pair_lost_s = 0;                ///< total time in which few fixes have a valid heading of the pair
  std::uint64_t events_missing = 0;      ///< gaps in the numbering of the sensor streams, last two minutes
  std::uint64_t events_expected = 0;     ///< including the missing ones
  std::optional<double> bridge_ahead_s;  ///< median of the bridge's timestamp minus the time of reception
  std::vector<ProcessObservation> bridges;    ///< processes that publish its IMU samples
  std::optional<BeaconStatus> status_before;  ///< first status in the window
  std::optional<BeaconStatus> status;         ///< last status
  std::optional<FusionStatus> fusion_before;
  std::optional<FusionStatus> fusion;
  std::vector<FusionStatus> fusions;  ///< last status of each running fusion of the beacon
  std::vector<FusionSpan>
      ended_fusions;  ///< ended fusions whose poses consumers received: their losses count too
  StatusCounts status_counts;
  FixOutcomes fix_outcomes;
  std::optional<estimation::aiding::HeightProblem> height_problem;
  std::uint64_t pair_fixes = 0;            ///< fixes that are the centre of a pair
  settings::Settings fusion_settings;      ///< settings of its fusion; the defaults if unknown
  std::uint64_t timed_fixes = 0;           ///< fixes whose delay was measured by the hardware
  double min_fix_delay_s = 0;              ///< minimum time from emission to receipt
  std::vector<motion::fit::Piece> pieces;  ///< fits of the installation to IMU and fixes
  motion::ImuSummary imu_summary;          ///< summary with the calibration applied
  motion::TurnGain turn_gain;              ///< gain of the calibrated gyroscope
  std::vector<std::string> imu_faults;     ///< texts of motion::imu_faults_of
  std::vector<motion::FixFault> fix_faults;
  std::optional<std::string> velocity_fault;  ///< text of recording::VelocityCheck::unit
  std::optional<RestObservation> rest;        ///< empty if it does not rest
};

struct Observations {
  double window_s = 0;
  std::optional<double> cut_from_s;  ///< requested window, if the user stopped it earlier
  std::string own_host;
  BusObservation bus;
  std::vector<NativeTopic> native_topics;
  std::vector<EndpointObservation> writers;  ///< without those of this process
  std::vector<EndpointObservation> readers;  ///< without those of this process
  std::vector<LineStatus> lines;             ///< last status of each line
  std::vector<observation::PoseWriter> pose_writers;
  std::vector<BeaconObservation> beacons;
  std::size_t beacons_not_fitted = 0;          ///< beacons without fits, for lack of time
  std::optional<std::string> beacons_refused;  ///< warning about too many beacons
  std::vector<std::string> not_observed;       ///< one text each for fusions and lines beyond the limits
};

/// The endpoints of one topic.
std::vector<const EndpointObservation*> on_topic(const std::vector<EndpointObservation>& endpoints,
                                                 const std::string& topic);

}  // namespace sonopose::doctor::rules
