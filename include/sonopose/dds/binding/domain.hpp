#pragma once
/// \file
/// How the processes join a DDS domain: its id, the network, and the fixed part of the configuration.

#include <dds/dds.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::dds {

/// The highest domain id whose ports exist (7400 + 250 · id and up).
inline constexpr std::uint32_t max_domain_id = 232;

enum class Network : std::uint8_t {
  loopback,  ///< this machine only, without multicast: works on every machine without setup
  lan,       ///< the interface that Cyclone DDS chooses, with multicast if possible
  /// Loopback and that interface, without multicast: processes on loopback, and ROS 2 nodes that are confined
  /// to this machine.
  ros_localhost,
  /// The same two, with multicast: also ROS 2 nodes that announce themselves by multicast alone, and those of
  /// other machines.
  ros_subnet
};

struct DomainOptions {
  std::optional<std::uint32_t> domain_id = std::nullopt;  ///< empty: ROS_DOMAIN_ID, else 0
  Network network = Network::loopback;
  /// Addresses or names of other machines to search for processes.
  std::vector<std::string> peers = {};
  /// The partition of the readers and writers; empty: none. Readers may match several by a pattern
  /// ("hall-*").
  std::string partition = {};
  /// How long others keep a participant of this process that was killed; empty: 10 s, the default of Cyclone
  /// DDS. The participant repeats its announcement after four fifths of it.
  std::optional<std::chrono::seconds> lease = std::nullopt;
  /// Whether writers wait for slow readers, which bounds the memory of a writer that keeps all. Otherwise
  /// samples that a slow reader has not received are overwritten.
  bool wait_for_readers = false;
  /// Whether samples are batched until DataWriter::flush or a full packet.
  bool batch_writes = false;
};

/// The domain id for `options`. Throws std::invalid_argument with the name of the option or ROS_DOMAIN_ID and
/// its value, unless it is a number of 0…232.
std::uint32_t resolve_domain_id(const DomainOptions& options);

/// The environment variables that are set and not empty, by name.
std::map<std::string, std::string> environment_variables(const std::vector<std::string>& names);

/// The network settings of a user's CYCLONEDDS_URI for one domain.
struct UserNetwork {
  std::vector<std::string> interfaces;  ///< their names or addresses; empty if it lists none
  bool peers = false;                   ///< it lists peers
  bool without_multicast = false;       ///< AllowMulticast is false
};

/// `uri` is a comma-separated list of XML fragments, file names and file:// URIs. Parts that cannot be read
/// are ignored here; Cyclone DDS reports them.
UserNetwork network_named_by(const std::string& uri, std::uint32_t domain_id);

/// The Cyclone DDS configuration of this domain (the id in `options` is ignored): our defaults, overridden by
/// the user's CYCLONEDDS_URI (`user_uri`, may be empty), then the fixed part: one receive thread, on which
/// all data listeners of remote samples run. Cyclone DDS appends to lists of interfaces and peers, so our
/// defaults are left out if the user lists some for this domain; the peers of the options remain. Throws
/// std::invalid_argument for a peer that cannot be an address or a host name.
std::string domain_configuration(std::uint32_t domain_id, const DomainOptions& options,
                                 const std::string& user_uri);

/// A reference to the process's configured domain: the first one configures it, the last one closes it.
/// Throws `Error`, also if this process uses the domain with a different network, or if too few file
/// descriptors are free.
class DomainLease {
public:
  explicit DomainLease(const DomainOptions& options);
  DomainLease(const DomainLease&) = delete;
  DomainLease& operator=(const DomainLease&) = delete;
  DomainLease(DomainLease&& other) noexcept;
  DomainLease& operator=(DomainLease&& other) noexcept;
  ~DomainLease();

  std::uint32_t domain_id() const noexcept { return id_; }

private:
  void release() noexcept;

  std::uint32_t id_ = 0;
  bool held_ = false;
};

}  // namespace sonopose::dds
