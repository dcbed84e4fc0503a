#pragma once
/// \file
/// What is wrong with a running system, and what to do: from observations to findings, without DDS entities,
/// clocks or threads.

#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include <sonopose/dds/binding/qos.hpp>

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::doctor {

/// A process behind a reader or writer, as far as its DDS implementation tells of it.
struct ProcessObservation {
  std::string name;
  std::string host;
  std::optional<std::uint32_t> id;
};

/// "sonopose-bridge (process 812 on rover)", "an unknown process".
std::string text_of(const ProcessObservation& process);

/// A reader or writer of another process.
struct EndpointObservation {
  std::string topic;
  std::string type;
  dds::Qos qos;
  ProcessObservation process;
};

/// A native topic as it should be.
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

/// Another domain of the same network in which processes of this system were found.
struct DomainObservation {
  std::uint32_t id = 0;
  bool beacons = false;  ///< IMU samples are published there
  bool poses = false;    ///< poses are
  bool ours = false;     ///< anybody is on one of this system's topics
};

struct BusObservation {
  std::uint32_t domain_id = 0;
  bool loopback_only = true;      ///< other machines cannot be found
  std::string interfaces_in_use;  ///< in words: "lo", "eth0 10.0.0.2"
  std::vector<InterfaceObservation> interfaces;
  bool peers_named = false;  ///< by CYCLONEDDS_URI
  bool looked_elsewhere = false;
  std::vector<DomainObservation> other_domains;
};

/// One stream of one beacon over the window.
struct StreamObservation {
  std::uint64_t samples = 0;
  double rate_hz = 0;
  double longest_silence_s = 0;                                 ///< until the window's end too
  double deadline_s = std::numeric_limits<double>::infinity();  ///< of the profile
};

/// Means and spreads of the IMU over the window, in body axes, as the fusion's calibration makes them.
struct RestObservation {
  Vector3d mean_force_body_mps2 = Vector3d::Zero();
  Vector3d mean_rate_body_radps = Vector3d::Zero();
  double force_std_mps2 = 0;  ///< the largest of the three axes
  double rate_std_radps = 0;
  double fixes_span_m = 0;         ///< how far the fixes lie apart; 0 without two
  calibration::AxesSettings axes;  ///< by which the fusion turns the sensor into the body
};

/// One beacon over the window.
struct BeaconObservation {
  BeaconAddress address = 0;
  StreamObservation imu;
  StreamObservation fix;
  StreamObservation heading;
  StreamObservation pose;
  std::uint64_t valid_headings = 0;
  std::uint64_t events_missing = 0;      ///< gaps in the numbering of its three streams
  std::optional<double> bridge_ahead_s;  ///< median of the bridge's stamp minus this clock at the receipt
  std::vector<ProcessObservation> bridges;      ///< who publishes its IMU samples
  std::optional<BeaconStatus> status_before;  ///< the first in the window
  std::optional<BeaconStatus> status;         ///< the last one
  std::optional<FusionStatus> fusion_before;
  std::optional<FusionStatus> fusion;
  std::vector<FusionStatus> fusions;  ///< the last one of each fusion that serves it
  std::uint32_t lasting_status = 0;   ///< bits of PoseStatus that each pose of the window had
  std::optional<RestObservation> imu_means;
};

struct Observations {
  double window_s = 0;
  std::string own_host;
  BusObservation bus;
  std::vector<NativeTopic> native_topics;
  std::vector<EndpointObservation> writers;  ///< without this process's own
  std::vector<EndpointObservation> readers;
  std::vector<BeaconObservation> beacons;
};

enum class Severity : std::uint8_t { ok, note, warning, error };

struct Finding {
  Severity severity = Severity::ok;
  std::string subject;  ///< "sonopose/pose", "beacon 7"
  std::string what;     ///< in plain words
  std::string remedy;   ///< what to do; empty where nothing is
};

/// What there is to say, in the order bus, topics, beacons.
std::vector<Finding> diagnose(const Observations& seen);

/// Whether something is wrong: a warning or an error.
bool any_wrong(const std::vector<Finding>& findings);

}  // namespace sonopose::doctor
