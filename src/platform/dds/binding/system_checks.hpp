#pragma once
/// \file
/// Checks that the system has what a domain needs: where it is missing, Cyclone DDS crashes, hangs, or gives
/// no reason. Internal to this module. `about` names the domain.

#include <sonopose/dds/binding/domain.hpp>

#include <string>

namespace sonopose::dds {

/// Throws `Error` with the limit and the least sufficient one if too few file descriptors are free.
void check_free_descriptors(const std::string& about);

/// Throws `Error` with what may limit them if too few threads can start.
void check_free_threads(const std::string& about);

/// Throws `Error` if the daemon of the shared memory that the user enables does not run: Cyclone DDS would
/// ignore signals for a minute, and then abort.
void check_shared_memory(const std::string& about, const UserNetwork& user);

/// Says which interfaces there are, and how to get a missing one.
std::string interface_advice(Network network, const UserNetwork& user);

}  // namespace sonopose::dds
