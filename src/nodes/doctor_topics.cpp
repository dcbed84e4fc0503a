#include "doctor_rules.hpp"
#include <sonopose/dds/qos_match.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace sonopose::nodes::doctor {
namespace {

void look_at_type(const NativeTopic& topic, const EndpointSeen& endpoint, const char* does,
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
  if (mismatch.policy == "partition") return "let both ends be in one partition";
  return fmt::format(
      "let the reader ask for a {0} of {1}, or the writer offer one of {2}; programs of sonopose: give all "
      "of them the "
      "same --qos file (docs/qos.md)",
      mismatch.policy, mismatch.offered, mismatch.requested);
}

void look_at_pair(const NativeTopic& topic, const EndpointSeen& writer, const EndpointSeen& reader,
                  Findings& findings) {
  if (writer.type != reader.type) return;  // told already
  for (const dds::QosMismatch& mismatch : dds::qos_mismatches(writer.qos, reader.qos)) {
    findings.push_back({Severity::error, topic.name,
                        fmt::format("{} does not hear {}: {}", text_of(reader.process),
                                    text_of(writer.process), dds::text_of(mismatch)),
                        remedy_for(mismatch, topic)});
  }
}

/// Of several fusions one must be the stronger.
void look_at_standbys(const Observations& seen, Findings& findings) {
  std::map<std::int32_t, std::vector<std::string>> by_strength;
  for (const EndpointSeen* const writer : on_topic(seen.writers, "sonopose/pose")) {
    const auto strength = writer->qos.policy<dds::policy::OwnershipStrength>();
    by_strength[strength ? strength->value : 0].push_back(text_of(writer->process));
  }
  for (const auto& [strength, processes] : by_strength) {
    if (processes.size() < 2) continue;
    findings.push_back(
        {Severity::warning, "sonopose/pose",
         fmt::format("{} fusions of the same strength {}: {}; which of them is heard is chance",
                     processes.size(), strength, fmt::join(processes, ", ")),
         "stop all but one, or give a standby a lower ownership strength (docs/qos.md)"});
  }
  if (by_strength.size() > 1) {
    const auto& [strength, processes] = *by_strength.rbegin();
    findings.push_back(
        {Severity::ok,
         "sonopose/pose",
         fmt::format("{} is heard (strength {}), the others stand by", fmt::join(processes, ", "), strength),
         {}});
  }
}

}  // namespace

void look_at_topics(const Observations& seen, Findings& findings) {
  for (const NativeTopic& topic : seen.native_topics) {
    const auto writers = on_topic(seen.writers, topic.name);
    const auto readers = on_topic(seen.readers, topic.name);
    for (const EndpointSeen* const writer : writers) look_at_type(topic, *writer, "writes", findings);
    for (const EndpointSeen* const reader : readers) look_at_type(topic, *reader, "reads", findings);
    for (const EndpointSeen* const writer : writers) {
      for (const EndpointSeen* const reader : readers) look_at_pair(topic, *writer, *reader, findings);
    }
  }
  look_at_standbys(seen, findings);
}

}  // namespace sonopose::nodes::doctor
