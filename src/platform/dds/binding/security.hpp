#pragma once
/// \file
/// The properties that make a participant secure. Internal to this module.

#include <dds/dds.h>

#include <cstdint>
#include <string>

namespace sonopose::dds {

/// Adds the files of an enclave to the QoS of a participant.
void secure(dds_qos_t* qos, const std::string& enclave_folder);

/// Returns the meaning of a variable of the environment: "true" in any case, or else "false" or nothing.
/// Throws std::invalid_argument for another value.
bool is_true(const std::string& name, const std::string& value);

/// Number of handshakes so far whose limit of time was left out.
std::uint64_t unlimited_handshakes();

}  // namespace sonopose::dds
