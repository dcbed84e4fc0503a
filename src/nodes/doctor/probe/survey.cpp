#include "doctor/probe/survey.hpp"

#include "clocks/clocks.hpp"
#include "security/enclave.hpp"
#include <sonopose/dds/binding/network_interfaces.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <list>
#include <set>
#include <string>
#include <tuple>

namespace sonopose::doctor::probe {
namespace {

/// The highest domain whose ports exist.
constexpr std::uint32_t highest_domain = 232;

/// True if the topic has the prefix of this system. Each of its processes has an endpoint with it.
bool is_ours(const std::string& topic) {
  return topic.starts_with("sonopose/");
}

/// The interfaces that the user names, by name or address. A missing one has no multicast.
std::vector<rules::InterfaceObservation> named_interfaces(
    const dds::UserNetwork& user, const std::vector<dds::NetworkInterface>& of_machine) {
  std::vector<rules::InterfaceObservation> named;
  for (const std::string& name : user.interfaces) {
    if (name.empty()) continue;  // Cyclone DDS chooses one
    rules::InterfaceObservation observation{.name = name};
    for (const dds::NetworkInterface& interface : of_machine) {
      if (name != interface.name && name != interface.address) continue;
      observation.loopback = interface.loopback;
      observation.multicast = interface.multicast && !user.without_multicast;
    }
    named.push_back(observation);
  }
  return named;
}

/// A domain that this process has joined, and the observations there.
class Visit {
public:
  explicit Visit(const dds::DomainOptions& options)
      : domain_{.id = *options.domain_id},
        participant_(dds::ext::participant(options)),
        discovery_(participant_) {}

  void visit() {
    for (const auto& writer : discovery_.writers()) {
      domain_.beacons = domain_.beacons || writer.topic_name == dds::topics::imu.name;
      domain_.poses = domain_.poses || writer.topic_name == dds::topics::pose.name;
      domain_.ours = domain_.ours || is_ours(writer.topic_name);
    }
    for (const auto& reader : discovery_.readers()) domain_.ours = domain_.ours || is_ours(reader.topic_name);
  }

  [[nodiscard]] const rules::DomainObservation& domain() const { return domain_; }

private:
  rules::DomainObservation domain_;
  dds::domain::DomainParticipant participant_;
  dds::Discovery discovery_;
};

}  // namespace

Processes processes_in(const std::vector<dds::FoundParticipant>& participants) {
  Processes processes;
  for (const auto& found : participants) {
    processes[found.key] = {found.process_name, found.host_name, found.process_id};
  }
  return processes;
}

rules::ProcessObservation process_of(const Processes& processes, const std::string& key) {
  const auto found = processes.find(key);
  return found == processes.end() ? rules::ProcessObservation{} : found->second;
}

std::vector<rules::NativeTopic> native_topics() {
  std::vector<rules::NativeTopic> topics;
  const auto add = [&topics]<class T>(const dds::topics::Entry<T>& entry) {
    topics.push_back({entry.name, dds::TopicTraits<T>::descriptor().m_typename});
  };
  std::apply([&](const auto&... entry) { (add(entry), ...); }, dds::topics::all);
  return topics;
}

std::vector<rules::EndpointObservation> others_of(const std::vector<dds::FoundEndpoint>& endpoints,
                                                  const Processes& processes, const std::string& own_key) {
  std::vector<rules::EndpointObservation> others;
  for (const auto& endpoint : endpoints) {
    if (endpoint.participant_key == own_key) continue;
    others.push_back({endpoint.topic_name, endpoint.type_name, endpoint.qos,
                      process_of(processes, endpoint.participant_key)});
  }
  return others;
}

rules::BusObservation bus_of(const dds::DomainOptions& options) {
  rules::BusObservation bus;
  bus.domain_id = dds::resolve_domain_id(options);
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  const dds::UserNetwork user = dds::network_named_by(uri == nullptr ? "" : uri, bus.domain_id);
  const auto of_machine = dds::network_interfaces();
  const dds::NetworkChoice used = dds::choose_network(options, user, of_machine);
  bus.interfaces = named_interfaces(user, of_machine);
  if (user.interfaces.empty()) {
    bus.loopback_only = std::all_of(used.interfaces.begin(), used.interfaces.end(),
                                    [](const dds::NetworkInterface& each) { return each.loopback; });
  } else {
    bus.loopback_only = std::all_of(bus.interfaces.begin(), bus.interfaces.end(),
                                    [](const rules::InterfaceObservation& named) { return named.loopback; });
  }
  bus.interfaces_in_use = used.text;
  bus.is_network_missing = !used.is_ready;
  bus.has_peers = user.peers;
  bus.is_secured = !options.enclave_folder.empty();
  for (const auto& [enclave, expires_s] : security::expiries_beside(options.enclave_folder)) {
    const std::string warning = security::expiry_warning(expires_s, clocks::host_now() / 1'000'000'000);
    if (!warning.empty())
      bus.expiring.push_back(std::string("enclave ").append(enclave).append(" ").append(warning));
  }
  return bus;
}

namespace {

/// The domains of the UDP ports in use on this machine. A port of another program does no harm.
std::set<std::uint32_t> domains_with_ports() {
  // RTPS 2.3, 9.6.1.1: ports from 7400 + 250 · domain on.
  constexpr std::uint32_t port_base = 7400;
  constexpr std::uint32_t domain_gain = 250;
  std::set<std::uint32_t> ids;
  for (const char* const table : {"/proc/self/net/udp", "/proc/self/net/udp6"}) {
    std::ifstream stream(table);
    std::string line;
    std::getline(stream, line);  // column titles
    while (std::getline(stream, line)) {
      // " 12: 0100007F:1CF2 00000000:0000 07 …": the local port follows the second colon.
      const auto number_end = line.find(':');
      const auto port_begin = number_end == std::string::npos ? number_end : line.find(':', number_end + 1);
      if (port_begin == std::string::npos) continue;
      const auto port = static_cast<std::uint32_t>(std::strtoul(line.c_str() + port_begin + 1, nullptr, 16));
      if (port >= port_base) ids.insert((port - port_base) / domain_gain);
    }
  }
  return ids;
}

/// The domains to visit, likely ones first.
std::deque<std::uint32_t> domains_to_visit(const dds::DomainOptions& here) {
  const std::set<std::uint32_t> with_ports = domains_with_ports();
  std::deque<std::uint32_t> ids;
  const std::uint32_t own = dds::resolve_domain_id(here);
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  // Loopback: all processes are on this machine, and have ports.
  const bool only_here = here.network == dds::Network::loopback && (uri == nullptr || *uri == '\0');
  for (const bool likely : {true, false}) {
    for (std::uint32_t id = 0; id <= highest_domain; ++id) {
      if (id != own && with_ports.contains(id) == likely && (likely || !only_here)) ids.push_back(id);
    }
  }
  return ids;
}

/// Joins the first of these domains simultaneously, up to a limit, and removes them. Returns their number: 0
/// if the file descriptors suffice for none.
std::size_t visit_first(std::deque<std::uint32_t>& ids, const dds::DomainOptions& here,
                        const process::StopSignal& stop, rules::BusObservation& bus) {
  // Each domain has five threads and seven open files.
  constexpr std::size_t at_once = 32;
  std::list<Visit> visits;
  while (!ids.empty() && visits.size() < at_once) {
    try {
      visits.emplace_back(dds::DomainOptions{
          .domain_id = ids.front(), .network = here.network, .interfaces = here.interfaces});
    } catch (const dds::core::OutOfResourcesError&) {
      break;  // next time, when these are closed
    } catch (const dds::core::Exception&) {
      ++bus.domains_not_searched;  // others use its ports
    }
    ids.pop_front();
  }
  constexpr TimeNs discovery_ns = 300'000'000;  // takes 10 … 50 ms on one machine
  if (!visits.empty()) stop.wait_until(clocks::steady_now() + discovery_ns);
  for (Visit& each : visits) {
    each.visit();
    if (each.domain().ours) bus.other_domains.push_back(each.domain());
  }
  return visits.size();
}

/// Looks at loopback in the same domain, if this process does not use it.
void search_loopback(const process::StopSignal& stop, rules::BusObservation& bus) {
  const bool uses_loopback = bus.loopback_only && !bus.is_network_missing;
  if (uses_loopback || !bus.interfaces.empty()) return;
  std::deque<std::uint32_t> own{bus.domain_id};
  const std::size_t before = bus.other_domains.size();
  visit_first(own, {.domain_id = bus.domain_id, .network = dds::Network::loopback}, stop, bus);
  for (std::size_t i = before; i < bus.other_domains.size(); ++i) bus.other_domains[i].on_loopback = true;
}

}  // namespace

void search_other_domains(const dds::DomainOptions& here, const process::StopSignal& stop,
                          rules::BusObservation& bus, TimeNs max_duration_ns) {
  const SteadyTime end = clocks::steady_now() + max_duration_ns;
  search_loopback(stop, bus);
  if (bus.is_network_missing) return;
  std::deque<std::uint32_t> ids = domains_to_visit(here);
  bus.searched_other_domains = true;
  TimeNs longest_visit_ns = 0;
  while (!ids.empty() && !stop.requested()) {
    const SteadyTime began = clocks::steady_now();
    if (began + longest_visit_ns > end || visit_first(ids, here, stop, bus) == 0) break;
    longest_visit_ns = std::max<TimeNs>(longest_visit_ns, clocks::steady_now() - began);
  }
  bus.domains_not_searched += ids.size();
}

}  // namespace sonopose::doctor::probe
