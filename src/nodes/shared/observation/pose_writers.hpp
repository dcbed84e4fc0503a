#pragma once
/// \file
/// Finds the processes that write poses, and those that should not. The pose topic has exclusive ownership,
/// so consumers receive only the strongest writer, and do not notice whose it is.

#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/types.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sonopose::observation {

/// A process as its participant announces it. Fields that its DDS implementation omits are empty.
struct ProcessIdentity {
  std::string name;
  std::string host;
  std::optional<std::uint32_t> id;

  bool operator==(const ProcessIdentity&) const = default;
};

/// Text such as "sonopose-bridge (process 812 on rover)" or "an unknown process".
std::string text_of(const ProcessIdentity& process);

/// Beacons that each writer serves, by the handle of its writer of poses or statuses.
class ServedBeacons {
public:
  void on(const FusedPose& pose, dds::InstanceHandle writer) { on_pose(pose.address, writer); }
  void on_pose(BeaconAddress address, dds::InstanceHandle writer) { owners_[address] = writer; }
  void on(const FusionStatus& status, dds::InstanceHandle writer);

  /// Forgets a beacon that is gone.
  void forget(BeaconAddress address);

  [[nodiscard]] std::set<BeaconAddress> of(dds::InstanceHandle writer) const;

  /// Writer of the beacon's latest pose; empty without one.
  [[nodiscard]] std::optional<dds::InstanceHandle> pose_writer_of(BeaconAddress address) const;

private:
  std::map<BeaconAddress, dds::InstanceHandle> owners_;  ///< writers of the latest poses
  std::map<dds::InstanceHandle, std::set<BeaconAddress>> statuses_;
};

/// A writer of the pose topic.
struct PoseWriter {
  std::string participant_key;
  ProcessIdentity process;
  dds::Qos qos;                    ///< with ownership strength and partition
  bool has_status = false;         ///< the participant writes fusion statuses too
  std::set<BeaconAddress> served;  ///< beacons that the participant serves
};

/// Pose writers among all writers of the domain.
std::vector<PoseWriter> pose_writers_of(const std::vector<dds::FoundEndpoint>& writers,
                                        const std::vector<dds::FoundParticipant>& participants,
                                        const ServedBeacons& served);

struct PoseWriterProblem {
  bool foreign = false;  ///< a writer that is no fusion; otherwise two fusions of equal strength
  std::string what;      ///< text that names the processes
  std::string remedy;
};

/// Processes that write poses without fusion statuses, and pairs of processes that write poses of one beacon
/// with equal strength. Strength 0 means that a fusion warms up.
std::vector<PoseWriterProblem> problems_of(const std::vector<PoseWriter>& writers);

}  // namespace sonopose::observation
