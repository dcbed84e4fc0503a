#pragma once
/// \file
/// The properties that make a participant secure. Internal to this module.

#include <sonopose/dds/binding/qos.hpp>

#include <string>

namespace sonopose::dds {

/// Returns the QoS of a participant with the files of an enclave; unchanged for an empty folder.
Qos secured(const Qos& qos, const std::string& enclave_folder);

}  // namespace sonopose::dds
