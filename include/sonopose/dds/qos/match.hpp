#pragma once
/// \file
/// Compatibility of a writer and a reader of one topic, with the reasons for a mismatch. Implements the
/// request/offer rules of DDS 1.4 (2.2.3) and of DDS-XTypes (data representation), as in Cyclone DDS. Pure
/// functions.

#include <sonopose/dds/psm/qos.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::dds::qos {

/// A policy for which writer and reader do not match.
struct Mismatch {
  std::uint32_t policy_id = 0;  ///< DDS_…_QOS_POLICY_ID, as in the incompatible-QoS statuses
  std::string policy;           ///< name, such as "deadline"
  std::string offered;          ///< writer's value, such as "200 ms"
  std::string requested;        ///< reader's value, such as "100 ms"
  std::string rule;             ///< rule, such as "a reader must not request less than is offered"
};

/// Policies for which they do not match; empty if they match. Unset policies have the DDS default (a writer
/// is reliable, a reader best effort).
std::vector<Mismatch> mismatches(const Qos& writer, const Qos& reader);

/// Mismatch as text: "deadline: offered 200 ms, requested 100 ms: a reader must not request less than is
/// offered".
std::string text_of(const Mismatch& mismatch);

/// A duration as text: "0", "2 ms", "1.5 s", "infinite" for the longest.
std::string text_of(std::chrono::nanoseconds duration);

}  // namespace sonopose::dds::qos
