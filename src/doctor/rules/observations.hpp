#pragma once
/// \file
/// Observations of a running system, as collected by doctor/probe: values without DDS entities, clocks or
/// threads.

#include "doctor/motion/window_fit.hpp"
#include "observation/pose_writers.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/dds/binding/qos.hpp>
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

/// An interface that the user's CYCLONEDDS_URI names.
struct InterfaceObservation {
  std::string name;
  bool multicast = false;
  bool loopback = false;
};

/// Another domain of the same network with processes of this system.
struct DomainObservation {
  std::uint32_t id = 0;
  bool beacons = false;  ///< IMU samples are published
  bool poses = false;    ///< poses are published
  bool ours = false;     ///< there is an endpoint of any native topic
};

struct BusObservation {
  std::uint32_t domain_id = 0;
  bool loopback_only = true;      ///< other machines cannot be discovered
  std::string interfaces_in_use;  ///< as text: "lo", "eth0 10.0.0.2"
  std::vector<InterfaceObservation> interfaces;
  bool has_peers = false;  ///< CYCLONEDDS_URI names peers
  bool searched_other_domains = false;
  std::vector<DomainObservation> other_domains;
  std::size_t domains_not_searched = 0;  ///< the time or the file descriptors did not suffice for them
};

/// One stream of one beacon over the window.
struct StreamObservation {
  std::uint64_t samples = 0;
  double rate_hz = 0;
  double longest_silence_s = 0;  ///< including the one at the end of the window
  double deadline_s = std::numeric_limits<double>::infinity();  ///< of the QoS profile
  std::uint64_t silences = 0;                                   ///< longer than the deadline
  double silent_s = 0;                                          ///< their total
};

/// Means of the IMU over the longest time at rest, in body axes, with the fusion's calibration applied.
struct RestObservation {
  Vector3d mean_force_body_mps2 = Vector3d::Zero();
  Vector3d mean_rate_body_radps = Vector3d::Zero();
  calibration::AxesSettings axes;
};

/// How many poses of the window have each bit of PoseStatus.
class StatusCounts {
public:
  void add(std::uint32_t status) {
    ++poses_;
    for (std::size_t i = 0; i < bits_.size(); ++i) bits_.at(i) += (status >> i) & 1U;
  }
  /// The share of the poses; 0 without poses.
  [[nodiscard]] double share_of(PoseStatus bit) const {
    const auto count = bits_.at(static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(bit))));
    return poses_ == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(poses_);
  }

private:
  std::uint64_t poses_ = 0;
  std::array<std::uint64_t, 32> bits_{};
};

/// What the fusion did with the fixes of the last two minutes.
struct FixOutcomes {
  std::uint64_t reports = 0;
  std::uint64_t refused = 0;         ///< too old, too poor or not valid
  std::uint64_t late = 0;            ///< of these: too old
  std::vector<Vector3d> outliers_m;  ///< innovations of those that it rejected as outliers, world
  std::uint64_t relocations = 0;     ///< jumps by more than 0.3 m to other fixes, not after a freeze
  double longest_relocation_m = 0;
};

/// The first and the last status of one fusion in the window.
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
  std::uint64_t valid_headings = 0;
  double pair_lost_s = 0;                   ///< the time in which few fixes have a valid heading
  std::uint64_t events_missing = 0;         ///< gaps in the numbering of the sensor streams, last two minutes
  std::uint64_t events_expected = 0;        ///< with the missing ones
  std::optional<double> bridge_ahead_s;     ///< median of the bridge's timestamp minus the time of reception
  std::vector<ProcessObservation> bridges;  ///< the processes that publish its IMU samples
  std::optional<BeaconStatus> status_before;  ///< the first status in the window
  std::optional<BeaconStatus> status;         ///< the last status
  std::optional<FusionStatus> fusion_before;
  std::optional<FusionStatus> fusion;
  std::vector<FusionStatus> fusions;      ///< the last status of each fusion of the beacon that runs
  std::vector<FusionSpan> ended_fusions;  ///< those that served it and have ended: their losses count too
  StatusCounts status_counts;
  FixOutcomes fix_outcomes;
  std::uint64_t pair_fixes = 0;         ///< fixes that are the centre of a pair
  settings::Settings fusion_settings;   ///< of its fusion; the defaults if it is not known
  std::uint64_t timed_fixes = 0;        ///< fixes with a delay that the hardware measured
  std::vector<motion::Piece> pieces;    ///< what IMU and fixes say about the installation
  std::optional<RestObservation> rest;  ///< empty if it does not rest
};

struct Observations {
  double window_s = 0;
  std::optional<double> cut_from_s;  ///< the window that was asked for, if the user stopped it earlier
  std::string own_host;
  BusObservation bus;
  std::vector<NativeTopic> native_topics;
  std::vector<EndpointObservation> writers;  ///< without those of this process
  std::vector<EndpointObservation> readers;  ///< without those of this process
  std::vector<LineStatus> lines;             ///< the last status of each
  std::vector<observation::PoseWriter> pose_writers;
  std::vector<BeaconObservation> beacons;
  std::size_t beacons_not_fitted = 0;          ///< the time did not suffice for their pieces
  std::optional<std::string> beacons_refused;  ///< the warning, if there were too many to look at
  std::vector<std::string> not_observed;  ///< fusions and lines beyond the limits, one text for each kind
};

/// The endpoints of one topic.
std::vector<const EndpointObservation*> on_topic(const std::vector<EndpointObservation>& endpoints,
                                                 const std::string& topic);

}  // namespace sonopose::doctor::rules
