#include <sonopose/dds/domain.hpp>
#include <sonopose/dds/error.hpp>

#include <pugixml.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <ifaddrs.h>
#include <initializer_list>
#include <map>
#include <mutex>
#include <net/if.h>
#include <sstream>
#include <stdexcept>
#include <strings.h>
#include <utility>

namespace sonopose::dds {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

bool same(const char* a, const char* b) {
  return strcasecmp(a, b) == 0;
}  // as Cyclone DDS compares names

bool applies(const pugi::xml_node& domain, std::uint32_t domain_id) {
  for (const pugi::xml_attribute attribute : domain.attributes()) {
    if (same(attribute.name(), "id")) {
      return same(attribute.value(), "any") || attribute.value() == std::to_string(domain_id);
    }
  }
  return true;
}

std::string attribute_of(const pugi::xml_node& node, std::initializer_list<const char*> names) {
  for (const pugi::xml_attribute attribute : node.attributes()) {
    for (const char* const name : names) {
      if (same(attribute.name(), name)) return attribute.value();
    }
  }
  return {};
}

void look_for_lists(const pugi::xml_node& parent, std::uint32_t domain_id, UserNetwork& found) {
  for (const pugi::xml_node node : parent.children()) {
    if (same(node.name(), "Domain") && !applies(node, domain_id)) continue;
    if (same(node.name(), "NetworkInterface")) {
      found.interfaces.push_back(attribute_of(node, {"name", "address"}));
    }
    if (same(node.name(), "NetworkInterfaceAddress")) found.interfaces.emplace_back(node.child_value());
    if (same(node.name(), "AllowMulticast")) {
      found.without_multicast = same(node.child_value(), "false");
    }
    if (same(node.name(), "Peers")) found.peers = true;
    look_for_lists(node, domain_id, found);
  }
}

/// Participants of one machine find each other by trying the ports of all indices: 7410 + 250 · id + 2 ·
/// index. Index 119 is the last one before the ports of the next domain; in domain 232 the ports end before.
std::uint32_t max_participant_index(std::uint32_t domain_id) {
  const std::uint32_t first_port = 7410 + 250 * domain_id;
  return std::min<std::uint32_t>(119, (65535 - 1 - first_port) / 2);
}

std::string fragment(const std::string& content) {
  return "<CycloneDDS><Domain>" + content + "</Domain></CycloneDDS>";
}

/// Whether this machine has an interface besides loopback. Cyclone DDS refuses to be told of loopback twice.
bool has_other_interface() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return false;
  bool found = false;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    const bool usable = (each->ifa_flags & IFF_UP) != 0 && (each->ifa_flags & IFF_LOOPBACK) == 0;
    found = found || (usable && each->ifa_addr != nullptr && each->ifa_addr->sa_family == AF_INET);
  }
  freeifaddrs(first);
  return found;
}

std::string general(Network network) {
  const bool multicast = network == Network::ros_subnet && has_other_interface();
  std::string interfaces = multicast
                               ? R"(<NetworkInterface name="lo" multicast="true"/>)"  // else none anywhere
                               : R"(<NetworkInterface name="lo"/>)";
  if (network != Network::loopback && has_other_interface()) {
    interfaces += R"(<NetworkInterface autodetermine="true"/>)";
  }
  return "<Interfaces>" + interfaces + "</Interfaces>" +
         (multicast ? "" : "<AllowMulticast>false</AllowMulticast>");
}

std::string peers(const DomainOptions& options, const UserNetwork& user) {
  std::string list = user.peers ? "" : R"(<Peer address="127.0.0.1"/>)";
  for (const std::string& peer : options.peers) {
    if (peer.empty() || peer.find_first_of("<>&\"' \t") != std::string::npos) {
      throw std::invalid_argument("peer '" + peer + "': is no address or name of a machine");
    }
    list += "<Peer address=\"" + peer + "\"/>";
  }
  return list.empty() ? list : "<Peers>" + list + "</Peers>";
}

std::string defaults(std::uint32_t domain_id, const DomainOptions& options, const UserNetwork& user) {
  // With interfaces of the user's own, Cyclone DDS decides about multicast as usual.
  const bool ours = options.network != Network::lan && user.interfaces.empty();
  const std::string discovery = "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>" +
                                std::to_string(max_participant_index(domain_id)) +
                                "</MaxAutoParticipantIndex>" + peers(options, user);
  // How long each writer that goes waits for readers that do not answer. Cyclone DDS's own 1 s, one writer
  // after the other, would keep a process that was told to end for seconds.
  std::string internal = "<WriterLingerDuration>100 ms</WriterLingerDuration>";
  if (options.batch_writes) internal += "<WriteBatch>true</WriteBatch>";
  // Cyclone DDS holds a writer up when readers have not acknowledged so much, whatever its history keeps.
  if (!options.wait_for_readers) {
    internal +=
        "<Watermarks><WhcHigh>1 GB</WhcHigh><WhcHighInit>1 GB</WhcHighInit>"
        "<WhcAdaptive>false</WhcAdaptive></Watermarks>";
  }
  return fragment("<General>" + (ours ? general(options.network) : "") + "</General><Discovery>" + discovery +
                  "</Discovery><Internal>" + internal + "</Internal>");
}

/// The domains that this process has open.
struct OpenDomain {
  dds_entity_t entity = 0;
  DomainOptions options;
  int leases = 0;
};

/// Whether a domain that was opened so will do.
bool same_configuration(const DomainOptions& a, const DomainOptions& b) {
  return a.network == b.network && a.peers == b.peers && a.wait_for_readers == b.wait_for_readers &&
         a.batch_writes == b.batch_writes;
}

struct Registry {
  std::mutex mutex;
  std::map<std::uint32_t, OpenDomain> open;
};

Registry& registry() {
  static auto* instance = new Registry;  // never destroyed: leases may be static objects
  return *instance;
}

dds_entity_t create_domain(std::uint32_t id, const DomainOptions& options) {
  const std::string uri = environment("CYCLONEDDS_URI");
  std::string about = "domain " + std::to_string(id);
  if (!uri.empty()) about += ", CYCLONEDDS_URI=" + uri;
  return check("dds_create_domain", about,
               dds_create_domain(id, domain_configuration(id, options, uri).c_str()));
}

}  // namespace

std::uint32_t resolve_domain_id(const DomainOptions& options) {
  const auto fail = [](const std::string& name, const std::string& value) {
    throw std::invalid_argument(name + " is '" + value + "': a domain id is a whole number from 0 to " +
                                std::to_string(max_domain_id));
  };
  if (options.domain_id) {
    if (*options.domain_id > max_domain_id) fail("the domain option", std::to_string(*options.domain_id));
    return *options.domain_id;
  }
  const std::string text = environment("ROS_DOMAIN_ID");
  if (text.empty()) return 0;
  std::uint32_t id = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, id);
  if (error != std::errc() || rest != end || id > max_domain_id) fail("ROS_DOMAIN_ID", text);
  return id;
}

std::map<std::string, std::string> environment_variables(const std::vector<std::string>& names) {
  std::map<std::string, std::string> found;
  for (const std::string& name : names) {
    const std::string value = environment(name.c_str());
    if (!value.empty()) found.emplace(name, value);
  }
  return found;
}

UserNetwork network_named_by(const std::string& uri, std::uint32_t domain_id) {
  UserNetwork found;
  pugi::xml_document fragments;
  fragments.load_string(uri.c_str(), pugi::parse_default | pugi::parse_fragment);
  look_for_lists(fragments, domain_id, found);
  for (const pugi::xml_node node : fragments.children()) {
    if (node.type() != pugi::node_pcdata) continue;
    std::istringstream names(node.value());
    for (std::string name; std::getline(names, name, ',');) {
      name.erase(0, name.find_first_not_of(" \t\n"));
      if (name.rfind("file://", 0) == 0) name.erase(0, std::strlen("file://"));
      pugi::xml_document file;
      if (!name.empty() && file.load_file(name.c_str())) look_for_lists(file, domain_id, found);
    }
  }
  return found;
}

std::string domain_configuration(std::uint32_t domain_id, const DomainOptions& options,
                                 const std::string& user_uri) {
  const UserNetwork user = network_named_by(user_uri, domain_id);
  std::string configuration = defaults(domain_id, options, user);
  if (!user_uri.empty()) configuration += "," + user_uri;
  return configuration + "," +
         fragment("<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads></Internal>");
}

DomainLease::DomainLease(const DomainOptions& options) : id_(resolve_domain_id(options)) {
  const std::lock_guard lock(registry().mutex);
  const auto found = registry().open.find(id_);
  if (found == registry().open.end()) {
    // No entry before the domain stands: creating it may throw.
    const dds_entity_t entity = create_domain(id_, options);
    registry().open[id_] = {entity, options, 1};
  } else if (!same_configuration(found->second.options, options)) {
    throw Error("domain " + std::to_string(id_) +
                    " is in use in this process with another network, or another way of writing",
                DDS_RETCODE_PRECONDITION_NOT_MET);
  } else {
    ++found->second.leases;
  }
  held_ = true;
}

DomainLease::DomainLease(DomainLease&& other) noexcept
    : id_(other.id_), held_(std::exchange(other.held_, false)) {}

DomainLease& DomainLease::operator=(DomainLease&& other) noexcept {
  if (this != &other) {
    release();
    id_ = other.id_;
    held_ = std::exchange(other.held_, false);
  }
  return *this;
}

DomainLease::~DomainLease() {
  release();
}

void DomainLease::release() noexcept {
  if (!std::exchange(held_, false)) return;
  const std::lock_guard lock(registry().mutex);
  const auto found = registry().open.find(id_);
  if (--found->second.leases > 0) return;
  dds_delete(found->second.entity);
  registry().open.erase(found);
}

}  // namespace sonopose::dds
