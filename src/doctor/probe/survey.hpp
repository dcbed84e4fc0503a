#pragma once
// What the doctor sees of a domain besides the samples: its processes, readers and writers, and the network.

#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/domain.hpp>
#include "doctor/rules/doctor.hpp"
#include "process/stop_signal.hpp"

#include <map>
#include <string>
#include <vector>

namespace sonopose::doctor::doctor {

/// The processes of a domain by the key of their participant.
using Processes = std::map<std::string, ProcessObservation>;

Processes processes_in(const std::vector<dds::FoundParticipant>& participants);

/// The one with this key; an unknown one where discovery has not told of it.
ProcessObservation process_of(const Processes& processes, const std::string& key);

/// Every row of the wiring diagram.
std::vector<NativeTopic> native_topics();

/// The endpoints of other processes.
std::vector<EndpointObservation> others_of(const std::vector<dds::FoundEndpoint>& endpoints,
                                    const Processes& processes, const std::string& own_key);

/// Domain, interfaces and peers.
BusObservation bus_of(const dds::DomainOptions& options);

/// Joins other domains of the same network, one after the other, and tells in which of them this system runs.
std::vector<DomainObservation> look_elsewhere(const dds::DomainOptions& here, const process::StopSignal& stop);

}  // namespace sonopose::doctor::doctor
