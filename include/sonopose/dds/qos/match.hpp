#pragma once
/// \file
/// Whether a writer and a reader of one topic match, and if not, why: the request/offer rules of DDS 1.4
/// (2.2.3) and of DDS-XTypes (data representation) as implemented by Cyclone DDS. Pure functions.

#include <sonopose/dds/binding/qos.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::dds::qos {

/// One policy for which writer and reader do not match.
struct Mismatch {
  std::uint32_t policy_id = 0;  ///< DDS_…_QOS_POLICY_ID, as the incompatible-QoS statuses give it
  std::string policy;           ///< as text: "deadline"
  std::string offered;          ///< the writer's value: "200 ms"
  std::string requested;        ///< the reader's value: "100 ms"
  std::string rule;             ///< "a reader must not request less than is offered"
};

/// The policies for which they do not match; empty if they match. Policies that are not set
/// have the DDS default (a writer is reliable, a reader best effort).
std::vector<Mismatch> mismatches(const Qos& writer, const Qos& reader);

/// "deadline: offered 200 ms, requested 100 ms: a reader must not request less than is offered".
std::string text_of(const Mismatch& mismatch);

/// A duration as text: "0", "2 ms", "1.5 s", "infinite".
std::string text_of(Duration duration);

}  // namespace sonopose::dds::qos
