#pragma once
/// \file
/// The other ROS 2 processes of a domain, as shown by discovery.

#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/ros2/node/node.hpp>
#include <sonopose/samples/samples.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace sonopose::ros2 {

/// Kinds of other processes. A ROS 2 process is a participant that announces its enclave.
struct Graph {
  bool has_humble = false;    ///< true with a process of Humble or earlier
  bool has_jazzy = false;     ///< true with a process of Iron or later
  bool is_undecided = false;  ///< true with a process not known for long enough to be one of them
  bool has_fast_dds = false;  ///< true with any participant of Fast DDS, by its vendor id
};

/// Layout of `ros_discovery_info` that harms no process of `graph`; empty without a ROS 2 process. A process
/// of Iron or later reads Humble's layout as a participant without nodes. A process of Humble that reads the
/// later layout cannot list any node.
std::optional<Distro> layout_for(const Graph& graph);
inline constexpr Distro layout_without_others = Distro::humble;

/// Observes the other ROS 2 processes of a domain. Not thread-safe.
class GraphObserver {
public:
  /// `on_change`: see dds::Discovery.
  explicit GraphObserver(const dds::domain::DomainParticipant& participant,
                         std::function<void()> on_change = {});

  /// Reads the processes other than the own participant. Call it after every change, and later while
  /// `is_undecided`. Throws dds::core::Exception.
  Graph observe(SteadyTime now);

private:
  /// Evidence in the endpoints of a process, including those that it has removed: one that ends removes them
  /// before itself.
  struct Process {
    void add(const dds::FoundEndpoint& endpoint);

    SteadyTime first_seen;
    std::optional<bool> discovery_has_hash = {};  ///< endpoint of ros_discovery_info has a type hash
    bool any_has_hash = false;
  };

  dds::Discovery discovery_;
  std::map<std::string, Process> processes_;  ///< by the key of the participant
};

}  // namespace sonopose::ros2
