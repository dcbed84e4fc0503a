#pragma once
/// \file
/// Finds the processes that write poses, and those that should not. The pose topic has exclusive ownership,
/// so consumers receive only the strongest writer, and do not notice whose it is.

#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>
#include <sonopose/samples/time.hpp>

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
  std::string addresses = {};  ///< network addresses, in the notation of Cyclone DDS

  bool operator==(const ProcessIdentity&) const = default;
};

/// Text such as "sonopose-bridge (process 812 on rover)" or "an unknown process".
std::string text_of(const ProcessIdentity& process);

/// Beacons that each writer serves, by the handle of its writer of poses or statuses.
class ServedBeacons {
public:
  static constexpr std::size_t max_writers = 1024;  ///< limit of writers of statuses

  /// Writer whose poses of a beacon are received.
  struct Owner {
    dds::core::InstanceHandle writer;
    SteadyTime since;
    std::optional<dds::core::InstanceHandle>
        before;  ///< writer that it took the poses over from after seconds
  };

  /// Claim to a beacon in the statuses of one writer.
  struct Claim {
    bool serves = false;   ///< by the latest status
    bool is_sole = false;  ///< by the latest status, it serves and is in no standby pair
    SteadyTime since;      ///< time of the first status
  };
  using Claims = std::map<BeaconAddress, Claim>;

  void on_pose(BeaconAddress address, dds::core::InstanceHandle writer, SteadyTime now);
  /// Forgets the oldest writer beyond `max_writers`.
  void on(const FusionStatus& status, dds::core::InstanceHandle writer, SteadyTime now);

  /// Forgets a beacon that is gone.
  void forget(BeaconAddress address);

  [[nodiscard]] const std::map<BeaconAddress, Owner>& owners() const { return owners_; }

  /// Claims of a writer of statuses; null without statuses.
  [[nodiscard]] const Claims* claims_of(dds::core::InstanceHandle writer) const;

  /// Writer of the beacon's latest pose; empty without one.
  [[nodiscard]] std::optional<dds::core::InstanceHandle> pose_writer_of(BeaconAddress address) const;

private:
  std::map<BeaconAddress, Owner> owners_;
  std::map<dds::core::InstanceHandle, Claims> claims_;
};

/// A writer of the pose topic. The beacons are those of its participant.
struct PoseWriter {
  std::string participant_key;
  ProcessIdentity process;
  dds::Qos qos;                           ///< with ownership strength and partition
  bool has_status = false;                ///< the participant writes fusion statuses too
  std::set<BeaconAddress> served = {};    ///< by its statuses, or because its poses are received
  std::set<BeaconAddress> sole = {};      ///< served outside of a standby pair, by its statuses
  std::set<BeaconAddress> owned = {};     ///< its poses are received
  std::set<BeaconAddress> unstated = {};  ///< owned for seconds without a status
  /// Beacons taken over from a fusion that still serves them, without a status of them before.
  std::map<BeaconAddress, ProcessIdentity> seized = {};
  dds::core::InstanceHandle handle = {};
};

/// Pose writers among all writers of the domain.
std::vector<PoseWriter> pose_writers_of(const std::vector<dds::FoundEndpoint>& writers,
                                        const std::vector<dds::FoundParticipant>& participants,
                                        const ServedBeacons& served, SteadyTime now);

struct PoseWriterProblem {
  bool foreign = false;  ///< a writer that is no fusion; otherwise two fusions of equal strength
  std::string what;      ///< text that names the processes
  std::string remedy;
};

/// Processes that write poses without being a fusion, by what a fusion does: it sends statuses of its
/// beacons, does so before it takes one over, and has at most max_fusion_strength. Also pairs of processes
/// that write poses of one beacon with equal strength, or of which one is in no standby pair. Strength 0
/// means that a fusion warms up.
std::vector<PoseWriterProblem> problems_of(const std::vector<PoseWriter>& writers);

}  // namespace sonopose::observation
