#pragma once
/// \file
/// Membership of processes in a DDS domain: its id, the network, and the fixed part of the configuration.

#include <dds/dds.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::dds {

/// Highest domain id whose ports exist (7400 + 250 · id and up).
inline constexpr std::uint32_t max_domain_id = 232;

enum class Network : std::uint8_t {
  loopback,  ///< this machine only, without multicast: works on every machine without setup
  lan,       ///< one other interface (choose_network), with multicast if possible
  /// Loopback and the interface of `lan`, without multicast. Reaches processes on loopback, and ROS 2 nodes
  /// confined to this machine.
  ros_localhost,
  /// Like `ros_localhost`, with multicast. Also reaches ROS 2 nodes that announce themselves by multicast
  /// alone, and those of other machines.
  ros_subnet
};

struct DomainOptions {
  std::optional<std::uint32_t> domain_id = std::nullopt;  ///< empty: ROS_DOMAIN_ID, otherwise 0
  Network network = Network::loopback;
  /// Names or addresses of the interfaces to use instead of those of `network`; those for ROS 2 keep
  /// loopback.
  std::vector<std::string> interfaces = {};
  /// Addresses or names of other machines to search for processes.
  std::vector<std::string> peers = {};
  /// Partition of the readers and writers; empty: none. A reader's pattern ("hall-*") may match several.
  std::string partition = {};
  /// Time for which others keep a killed participant of this process; empty: 10 s, the default of Cyclone
  /// DDS. The participant repeats its announcement after four fifths of it.
  std::optional<std::chrono::seconds> lease = std::nullopt;
  /// True if writers wait for slow readers, which bounds the memory of a keep-all writer. Otherwise samples
  /// that a slow reader has not received are overwritten.
  bool wait_for_readers = false;
  /// True if samples are batched until ext::flush or a full packet.
  bool batch_writes = false;
  /// Folder of a security enclave, with the files of SROS2. Empty: as ROS 2's variables say
  /// (enclave_by_environment), otherwise without security.
  std::string enclave_folder = {};
};

/// Returns the folder of the enclave `name` in ROS_SECURITY_KEYSTORE; of ROS_SECURITY_ENCLAVE_OVERRIDE, or
/// else of `consumer`, for an empty name. Empty unless ROS_SECURITY_ENABLE is true, and for a missing folder
/// if ROS_SECURITY_STRATEGY is Permissive. Throws std::invalid_argument without a key store.
std::string enclave_by_environment(const std::string& name = {});

/// Domain id for `options`. Throws std::invalid_argument unless it is a number of 0…232, naming the option or
/// ROS_DOMAIN_ID, and its value.
std::uint32_t resolve_domain_id(const DomainOptions& options);

/// Those of the environment variables that are set and not empty, by name.
std::map<std::string, std::string> environment_variables(const std::vector<std::string>& names);

/// Network settings of a user's CYCLONEDDS_URI for one domain.
struct UserNetwork {
  std::vector<std::string> interfaces;  ///< names or addresses of listed interfaces
  bool peers = false;                   ///< true if it lists peers
  bool without_multicast = false;       ///< true if AllowMulticast is false
  bool shared_memory = false;           ///< true if SharedMemory is enabled
  bool other_transport = false;         ///< true if it selects IPv6 or TCP
};

/// Reads `uri`, a comma-separated list of XML fragments, file names and file:// URIs. Unreadable parts are
/// ignored; Cyclone DDS reports them.
UserNetwork network_named_by(const std::string& uri, std::uint32_t domain_id);

/// Cyclone DDS configuration of this domain; the id in `options` is ignored. Our defaults come first, then
/// the user's CYCLONEDDS_URI (`user_uri`, may be empty), then the fixed part: one receive thread, on which
/// all data listeners of remote samples run. Cyclone DDS appends to lists of interfaces and peers. Our
/// defaults are therefore left out if the user lists some for this domain; the peers of the options remain.
/// Throws std::invalid_argument for a peer that cannot be an address or a host name.
std::string domain_configuration(std::uint32_t domain_id, const DomainOptions& options,
                                 const std::string& user_uri);

enum class MessageLevel : std::uint8_t {
  info,
  warning,
  error,
  fatal  ///< Cyclone DDS ends the process after this message
};

/// Receives the messages of Cyclone DDS, each without a line feed, on any thread. It must not call DDS.
using MessageSink = std::function<void(MessageLevel, std::string_view)>;

/// Passes later messages of Cyclone DDS in this process to `sink` instead of standard error. Many of them
/// are about samples and announcements of others, and have no end. Call it before there is a domain.
void send_messages_to(MessageSink sink);

/// A reference to the process's configured domain: the first one configures it, the last one closes it.
/// Throws `Error`, also if this process uses the domain with a different network, if too few file descriptors
/// or threads are free, or if the user enables shared memory whose daemon does not run. Replaces the log sink
/// of Cyclone DDS while it opens the domain; afterwards that of send_messages_to() is in use.
class DomainLease {
public:
  explicit DomainLease(const DomainOptions& options);
  DomainLease(const DomainLease&) = delete;
  DomainLease& operator=(const DomainLease&) = delete;
  ~DomainLease();

  std::uint32_t domain_id() const noexcept { return id_; }

private:
  std::uint32_t id_;
};

}  // namespace sonopose::dds
