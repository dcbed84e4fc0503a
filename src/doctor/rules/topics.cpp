#include "doctor/rules/rules.hpp"
#include <sonopose/dds/qos/match.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::doctor::doctor {
namespace {

void check_type(const NativeTopic& topic, const EndpointObservation& endpoint, const char* does,
                  Findings& findings) {
  if (endpoint.type == topic.type) return;
  findings.push_back({Severity::error, topic.name,
                      fmt::format("{} {} it as type {}, and not {}", text_of(endpoint.process), does,
                                  endpoint.type, topic.type),
                      "build that program with this version's idl/sonopose.idl"});
}

std::string remedy_for(const dds::QosMismatch& mismatch, const NativeTopic& topic) {
  if (mismatch.policy == "ownership") {
    return fmt::format("let both ends of {} have {} ownership", topic.name, mismatch.offered);
  }
  return fmt::format(
      "let the reader ask for a {0} of {1}, or the writer offer one of {2}; programs of sonopose: give all "
      "of "
      "them the same --qos file (docs/qos.md)",
      mismatch.policy, mismatch.offered, mismatch.requested);
}

/// Whether the two are kept apart on purpose, as parts of a domain are.
bool in_other_parts(const EndpointObservation& writer, const EndpointObservation& reader) {
  const auto mismatches = dds::qos_mismatches(writer.qos, reader.qos);
  return std::any_of(mismatches.begin(), mismatches.end(),
                     [](const dds::QosMismatch& mismatch) { return mismatch.policy == "partition"; });
}

void check_pair(const NativeTopic& topic, const EndpointObservation& writer, const EndpointObservation& reader,
                  Findings& findings) {
  if (writer.type != reader.type || in_other_parts(writer, reader)) return;  // told already, or as meant
  for (const dds::QosMismatch& mismatch : dds::qos_mismatches(writer.qos, reader.qos)) {
    findings.push_back({Severity::error, topic.name,
                        fmt::format("{} does not hear {}: {}", text_of(reader.process),
                                    text_of(writer.process), dds::text_of(mismatch)),
                        remedy_for(mismatch, topic)});
  }
}

/// A part of the domain with a bridge and without a fusion.
void check_parts(const Observations& seen, Findings& findings) {
  const auto readers = on_topic(seen.readers, "sonopose/imu");
  for (const EndpointObservation* const writer : on_topic(seen.writers, "sonopose/imu")) {
    const bool alone =
        !readers.empty() && std::all_of(readers.begin(), readers.end(), [&](const EndpointObservation* reader) {
          return in_other_parts(*writer, *reader);
        });
    if (!alone) continue;
    findings.push_back({Severity::warning, "sonopose/imu",
                        fmt::format("nobody in its partition hears {}", text_of(writer->process)),
                        "give bridge and fusion the same --partition"});
  }
}

}  // namespace

void check_topics(const Observations& seen, Findings& findings) {
  for (const NativeTopic& topic : seen.native_topics) {
    const auto writers = on_topic(seen.writers, topic.name);
    const auto readers = on_topic(seen.readers, topic.name);
    for (const EndpointObservation* const writer : writers) check_type(topic, *writer, "writes", findings);
    for (const EndpointObservation* const reader : readers) check_type(topic, *reader, "reads", findings);
    for (const EndpointObservation* const writer : writers) {
      for (const EndpointObservation* const reader : readers) check_pair(topic, *writer, *reader, findings);
    }
  }
  check_parts(seen, findings);
}

}  // namespace sonopose::doctor::doctor
