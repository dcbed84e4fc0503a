#pragma once
/// \file
/// Processes that DDS Security refused.

#include <string>
#include <vector>

namespace sonopose::dds {

/// A refused process. Key and subject may both be unknown.
struct RefusedPeer {
  std::string key_prefix;  ///< first 24 digits of the key of its participant
  std::string subject;     ///< subject of its certificate: "/CN=/bridge"
  std::string reason;
};

/// "a process (certificate /CN=/bridge): REASON".
std::string text_of(const RefusedPeer& peer);

/// Returns the processes that participants of this process have refused so far: the first 64. Cyclone DDS
/// does not report those without a certificate, whose endpoints it hides, nor those whose enclave lacks a
/// topic.
std::vector<RefusedPeer> refused_peers();

}  // namespace sonopose::dds
