// Builds the configuration text for Cyclone DDS.

#include "loopback_xml.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/binding/network_interfaces.hpp>

#include <pugixml.hpp>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <sstream>
#include <stdexcept>
#include <strings.h>

namespace sonopose::dds {
namespace {

bool same(const char* a, const char* b) {
  return strcasecmp(a, b) == 0;
}  // ignores case like Cyclone DDS

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

/// Searches for network settings of the user. Cyclone DDS knows no element deeper than `levels`.
void look_for_lists(const pugi::xml_node& parent, std::uint32_t domain_id, UserNetwork& found,
                    int levels = 16) {
  if (levels == 0) return;
  for (const pugi::xml_node node : parent.children()) {
    if (same(node.name(), "Domain") && !applies(node, domain_id)) continue;
    if (same(node.name(), "NetworkInterface")) {
      found.interfaces.push_back(attribute_of(node, {"name", "address"}));
    }
    if (same(node.name(), "NetworkInterfaceAddress")) found.interfaces.emplace_back(node.child_value());
    if (same(node.name(), "AllowMulticast")) {
      found.without_multicast = same(node.child_value(), "false");
    }
    if (same(node.name(), "Transport") || same(node.name(), "UseIPv6")) {
      found.other_transport |= !same(node.child_value(), "udp") && !same(node.child_value(), "false") &&
                               !same(node.child_value(), "default");
    }
    if (same(node.name(), "Peers")) found.peers = true;
    if (same(node.name(), "Enable") && same(parent.name(), "SharedMemory")) {
      std::string value;
      std::istringstream(node.child_value()) >> value;  // without spaces around it
      found.shared_memory = same(value.c_str(), "true");
    }
    look_for_lists(node, domain_id, found, levels - 1);
  }
}

const pugi::xml_node& loopback_domain() {
  static const pugi::xml_document document = [] {
    pugi::xml_document parsed;
    parsed.load_string(loopback_xml);
    return parsed;
  }();
  static const pugi::xml_node domain = document.child("CycloneDDS").child("Domain");
  return domain;
}

/// Returns the content of an element as text.
std::string content_of(const pugi::xml_node& element) {
  std::ostringstream text;
  for (const pugi::xml_node child : element.children()) child.print(text, "", pugi::format_raw);
  return text.str();
}

/// Limits the ports of participants. Those of one machine find each other by trying the ports of all indices:
/// 7410 + 250 · id + 2 · index. The last index stays below the ports of the next domain; in domain 232, port
/// numbers end earlier.
std::uint32_t max_participant_index(std::uint32_t domain_id) {
  const std::uint32_t first_port = 7410 + 250 * domain_id;
  const std::uint32_t max_index =
      loopback_domain().child("Discovery").child("MaxAutoParticipantIndex").text().as_uint();
  return std::min<std::uint32_t>(max_index, (65535 - 1 - first_port) / 2);
}

std::string fragment(const std::string& content) {
  return "<CycloneDDS><Domain>" + content + "</Domain></CycloneDDS>";
}

/// Returns the interfaces, and turns multicast off where no other machine is to be found by it.
std::string general(const NetworkChoice& choice, Network network) {
  if (choice.interfaces.empty()) return {};
  const bool only_here = std::all_of(choice.interfaces.begin(), choice.interfaces.end(),
                                     [](const NetworkInterface& each) { return each.loopback; });
  const bool multicast = !only_here && network != Network::ros_localhost;
  std::string interfaces;
  for (const NetworkInterface& each : choice.interfaces) {
    interfaces.append(R"(<NetworkInterface name=")").append(each.name).append(R"(")");
    if (multicast && each.loopback) interfaces += R"( multicast="true")";  // otherwise none has multicast
    interfaces += "/>";
  }
  return "<Interfaces>" + interfaces + "</Interfaces>" +
         (multicast ? "" : "<AllowMulticast>false</AllowMulticast>");
}

std::string peers(const DomainOptions& options, const UserNetwork& user) {
  std::string list = user.peers ? "" : content_of(loopback_domain().child("Discovery").child("Peers"));
  for (const std::string& peer : options.peers) {
    if (peer.empty() || peer.find_first_of("<>&\"' \t") != std::string::npos) {
      throw std::invalid_argument("peer '" + peer + "': not an address or host name");
    }
    list += "<Peer address=\"" + peer + "\"/>";
  }
  return list.empty() ? list : "<Peers>" + list + "</Peers>";
}

std::string lease(const DomainOptions& options) {
  if (!options.lease) return {};
  return "<LeaseDuration>" + std::to_string(options.lease->count()) + " s</LeaseDuration>";
}

/// A participant without its permissions yet, which takes tens of milliseconds after it begins to listen,
/// refuses secured ones. Those that start together would find each other 8 s later.
std::string announcements(const DomainOptions& options) {
  return options.enclave_folder.empty() ? "" : "<SPDPInterval>2 s</SPDPInterval>";
}

std::string defaults(std::uint32_t domain_id, const DomainOptions& options, const UserNetwork& user,
                     const NetworkChoice& network) {
  const std::string discovery = "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>" +
                                std::to_string(max_participant_index(domain_id)) +
                                "</MaxAutoParticipantIndex>" + lease(options) + announcements(options) +
                                peers(options, user);
  // Limits the time that a deleted writer waits for readers that do not respond. The default of 1 s, one
  // writer after the other, would delay the exit of a process by seconds.
  std::string internal = "<WriterLingerDuration>100 ms</WriterLingerDuration>";
  // Limits the time after which a reader asks for a lost packet. The default of 100 ms is as long as the
  // lease and the deadline of the live streams: a single lost packet would silence a beacon.
  internal += "<NackDelay>10 ms</NackDelay>";
  // Limits the samples of a writer that wait for a lost one: its history of 64 for each of 256 beacons.
  // Samples beyond the default of 128 would be sent again and slow down a slow reader further.
  internal +=
      "<PrimaryReorderMaxSamples>16384</PrimaryReorderMaxSamples>"
      "<SecondaryReorderMaxSamples>16384</SecondaryReorderMaxSamples>";
  if (options.batch_writes) internal += "<WriteBatch>true</WriteBatch>";
  // Cyclone DDS blocks a keep-all writer above this amount of unacknowledged data. A keep-last writer is
  // never blocked by it: 0.10 sets its limits to the largest number (eclipse-cyclonedds#1777).
  if (!options.wait_for_readers) {
    internal +=
        "<Watermarks><WhcHigh>1 GB</WhcHigh><WhcHighInit>1 GB</WhcHighInit>"
        "<WhcAdaptive>false</WhcAdaptive></Watermarks>";
  }
  return fragment("<General>" + general(network, options.network) + "</General><Discovery>" + discovery +
                  "</Discovery><Internal>" + internal + "</Internal>");
}

}  // namespace

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
  return domain_configuration(domain_id, options, user_uri,
                              choose_network(options, user, network_interfaces()));
}

std::string domain_configuration(std::uint32_t domain_id, const DomainOptions& options,
                                 const std::string& user_uri, const NetworkChoice& network) {
  std::string configuration = defaults(domain_id, options, network_named_by(user_uri, domain_id), network);
  if (!user_uri.empty()) configuration += "," + user_uri;
  return configuration + "," +
         fragment("<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads></Internal>");
}

}  // namespace sonopose::dds
