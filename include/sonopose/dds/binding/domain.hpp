#pragma once
/// \file
/// How this system's processes join a DDS domain: which id, over which network, and what must hold always.

#include <dds/dds.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::dds {

/// The highest domain id whose ports exist (7400 + 250 · id and up).
inline constexpr std::uint32_t max_domain_id = 232;

enum class Network : std::uint8_t {
  loopback,  ///< this machine only, without multicast: works on every machine as it is
  lan,       ///< the interface that Cyclone DDS chooses, with multicast where it can
  /// Loopback and that interface, without multicast: processes on loopback, and ROS 2 nodes of this machine
  /// that keep to it.
  ros_localhost,
  /// The same two, with multicast: also ROS 2 nodes that announce themselves by multicast alone, and those of
  /// other machines.
  ros_subnet
};

struct DomainOptions {
  std::optional<std::uint32_t> domain_id = std::nullopt;  ///< empty: ROS_DOMAIN_ID, else 0
  Network network = Network::loopback;
  /// Addresses or names of machines to look for processes on, besides this one.
  std::vector<std::string> peers = {};
  /// The part of the domain whose topics are read and written; empty: what is in no part. Readers may name
  /// several by a pattern ("hall-*").
  std::string partition = {};
  /// Whether writers wait for readers that lag behind, which bounds the memory of one that keeps all. Else
  /// they write on: what a lagging reader has not got is overwritten, and nobody waits for it.
  bool wait_for_readers = false;
  /// Whether samples wait for DataWriter::flush, or a full packet, to travel together.
  bool batch_writes = false;
};

/// The id that `options` leads to. Throws std::invalid_argument that names the option or ROS_DOMAIN_ID and
/// the value where it is no number of 0…232.
std::uint32_t resolve_domain_id(const DomainOptions& options);

/// Those of the environment's variables that are set to something, by name.
std::map<std::string, std::string> environment_variables(const std::vector<std::string>& names);

/// What a user's CYCLONEDDS_URI says of the network in a domain.
struct UserNetwork {
  std::vector<std::string> interfaces;  ///< their names or addresses; empty where it leaves them to us
  bool peers = false;                   ///< it lists peers
  bool without_multicast = false;       ///< AllowMulticast is false
};

/// `uri` is a list of XML fragments, file names and file:// URIs with commas between. Whether they are right
/// is for Cyclone DDS to say: what cannot be read here names nothing.
UserNetwork network_named_by(const std::string& uri, std::uint32_t domain_id);

/// What Cyclone DDS is configured with for this domain (the id in `options` does not count): our defaults,
/// then the user's own CYCLONEDDS_URI (`user_uri`, may be empty), which wins, then what must hold: one
/// receive thread, on which all data listeners of remote samples run. Interfaces and peers are lists that
/// Cyclone DDS would append to, so ours stay out where the user names some for this domain; the peers of the
/// options stay. Throws std::invalid_argument for one that cannot be an address or a name.
std::string domain_configuration(std::uint32_t domain_id, const DomainOptions& options,
                                 const std::string& user_uri);

/// A share in the process's configured domain: the first one configures it, the last one closes it.
/// Throws `Error`; also where the domain is in use in this process with another network.
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
