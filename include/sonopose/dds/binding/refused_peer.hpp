#pragma once
/// \file
/// Processes that DDS Security refused.

#include <string>
#include <vector>

namespace sonopose::dds {

/// A refused process, by the one or the other.
struct RefusedPeer {
  std::string key_prefix;  ///< first 24 digits of the key of its participant; may be empty
  std::string subject;     ///< subject of its certificate: "/CN=/bridge"; may be empty
  std::string reason;
};

/// Returns the processes that participants of this process have refused so far: the first 64. Cyclone DDS
/// does not report those without a certificate, whose endpoints it hides, nor those whose enclave lacks a
/// topic.
std::vector<RefusedPeer> refused_peers();

}  // namespace sonopose::dds
