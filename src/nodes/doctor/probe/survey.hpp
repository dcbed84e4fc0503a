#pragma once
// Observations of a domain other than samples: processes, endpoints and network.

#include "doctor/rules/observations.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/psm/discovery.hpp>

#include <map>
#include <string>
#include <vector>

namespace sonopose::doctor::probe {

/// Processes of a domain by the key of their participant.
using Processes = std::map<std::string, rules::ProcessObservation>;

Processes processes_in(const std::vector<dds::FoundParticipant>& participants);

/// The process with this key; an empty observation if it is not discovered.
rules::ProcessObservation process_of(const Processes& processes, const std::string& key);

/// All topics of dds/topics/topics.hpp.
std::vector<rules::NativeTopic> native_topics();

/// Endpoints of other processes.
std::vector<rules::EndpointObservation> others_of(const std::vector<dds::FoundEndpoint>& endpoints,
                                                  const Processes& processes, const std::string& own_key);

/// Domain, interfaces and peers.
rules::BusObservation bus_of(const dds::DomainOptions& options);

/// Joins the other domains of the same network, several at a time, as long as `max_duration_ns` allows. On
/// loopback, visits those whose UDP ports are in use on this machine; otherwise all. If the network
/// is missing, visits loopback only. Writes to `bus` the
/// domains with processes of this system, and the number that could not be visited.
void search_other_domains(const dds::DomainOptions& here, const process::StopSignal& stop,
                          rules::BusObservation& bus, TimeNs max_duration_ns = 12'000'000'000);

}  // namespace sonopose::doctor::probe
