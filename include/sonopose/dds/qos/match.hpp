#pragma once
/// \file
/// Whether a writer and a reader of one topic match, and if not, why: the request/offer rules of DDS 1.4
/// (2.2.3) and of DDS-XTypes (data representation), as Cyclone DDS applies them, as a pure function.

#include <sonopose/dds/binding/qos.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::dds {

/// One policy for which writer and reader do not match.
struct QosMismatch {
  std::uint32_t policy_id = 0;  ///< DDS_…_QOS_POLICY_ID, as the incompatible-QoS statuses give it
  std::string policy;           ///< in words: "deadline"
  std::string offered;          ///< the writer's value: "200 ms"
  std::string requested;        ///< the reader's value: "100 ms"
  std::string rule;             ///< "a reader may not ask for less than is offered"
};

/// The policies for which they do not match; none where they match. What a QoS does not set has the default
/// of DDS (a writer is reliable, a reader best effort).
std::vector<QosMismatch> qos_mismatches(const Qos& writer, const Qos& reader);

/// "deadline: offered 200 ms, requested 100 ms: a reader may not ask for less than is offered".
std::string text_of(const QosMismatch& mismatch);

/// A duration in words: "0", "2 ms", "1.5 s", "infinite".
std::string text_of(Duration duration);

}  // namespace sonopose::dds
