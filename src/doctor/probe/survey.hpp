#pragma once
// Observations of a domain other than samples: its processes, endpoints and network.

#include "doctor/rules/observations.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/domain.hpp>

#include <map>
#include <string>
#include <vector>

namespace sonopose::doctor::probe {

/// The processes of a domain by the key of their participant.
using Processes = std::map<std::string, rules::ProcessObservation>;

Processes processes_in(const std::vector<dds::FoundParticipant>& participants);

/// The process with this key; an empty observation if it has not been discovered.
rules::ProcessObservation process_of(const Processes& processes, const std::string& key);

/// All topics of dds/topics/topics.hpp.
std::vector<rules::NativeTopic> native_topics();

/// The endpoints of other processes.
std::vector<rules::EndpointObservation> others_of(const std::vector<dds::FoundEndpoint>& endpoints,
                                                  const Processes& processes, const std::string& own_key);

/// Domain, interfaces and peers.
rules::BusObservation bus_of(const dds::DomainOptions& options);

/// Joins other domains of the same network, some at a time, until no more of them fit into `longest_ns`: on
/// loopback those of the UDP ports that are in use on this machine, otherwise all. Sets in `bus` those with
/// processes of this system, and how many could not be visited.
void search_other_domains(const dds::DomainOptions& here, const process::StopSignal& stop,
                          rules::BusObservation& bus, TimeNs longest_ns = 12'000'000'000);

}  // namespace sonopose::doctor::probe
