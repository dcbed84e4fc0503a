#include "doctor/rules/checks.hpp"
#include <sonopose/dds/qos/match.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::doctor::rules {
namespace {

void check_type(const NativeTopic& topic, const EndpointObservation& endpoint, const char* does,
                Findings& findings) {
  if (endpoint.type == topic.type) return;
  findings.push_back({Severity::error, topic.name,
                      fmt::format("{} {} it as type {} instead of {}", text_of(endpoint.process), does,
                                  endpoint.type, topic.type),
                      "build that program with the idl/sonopose.idl of this version"});
}

std::string remedy_for(const dds::qos::Mismatch& mismatch, const NativeTopic& topic) {
  if (mismatch.policy == "ownership") {
    return fmt::format("use {1} ownership for both endpoints of {0}", topic.name, mismatch.offered);
  }
  return fmt::format(
      "set {0} of the reader to {1}, or of the writer to {2}; for sonopose's programs, use the same --qos "
      "file "
      "for all (docs/qos.md)",
      mismatch.policy, mismatch.offered, mismatch.requested);
}

/// True if partitions separate the two on purpose.
bool in_different_partitions(const EndpointObservation& writer, const EndpointObservation& reader) {
  const auto mismatches = dds::qos::mismatches(writer.qos, reader.qos);
  return std::any_of(mismatches.begin(), mismatches.end(),
                     [](const dds::qos::Mismatch& mismatch) { return mismatch.policy == "partition"; });
}

void check_pair(const NativeTopic& topic, const EndpointObservation& writer,
                const EndpointObservation& reader, Findings& findings) {
  if (writer.type != reader.type || in_different_partitions(writer, reader))
    return;  // reported already, or intended
  for (const dds::qos::Mismatch& mismatch : dds::qos::mismatches(writer.qos, reader.qos)) {
    findings.push_back({Severity::error, topic.name,
                        fmt::format("{} cannot receive from {}: {}", text_of(reader.process),
                                    text_of(writer.process), dds::qos::text_of(mismatch)),
                        remedy_for(mismatch, topic)});
  }
}

/// True if type or QoS keep the two apart unintentionally.
bool is_mismatch(const EndpointObservation& writer, const EndpointObservation& reader) {
  if (writer.type != reader.type) return true;
  return !in_different_partitions(writer, reader) && !dds::qos::mismatches(writer.qos, reader.qos).empty();
}

/// Reports a partition that has a bridge but no fusion.
void check_partitions(const Observations& observations, Findings& findings) {
  const auto readers = on_topic(observations.readers, "sonopose/imu");
  for (const EndpointObservation* const writer : on_topic(observations.writers, "sonopose/imu")) {
    const bool alone = !readers.empty() &&
                       std::all_of(readers.begin(), readers.end(), [&](const EndpointObservation* reader) {
                         return in_different_partitions(*writer, *reader);
                       });
    if (!alone) continue;
    findings.push_back({Severity::warning, "sonopose/imu",
                        fmt::format("no reader is in the partition of {}", text_of(writer->process)),
                        "use the same --partition for bridge and fusion"});
  }
}

}  // namespace

void check_topics(const Observations& observations, Findings& findings) {
  for (const NativeTopic& topic : observations.native_topics) {
    const auto writers = on_topic(observations.writers, topic.name);
    const auto readers = on_topic(observations.readers, topic.name);
    for (const EndpointObservation* const writer : writers) check_type(topic, *writer, "writes", findings);
    for (const EndpointObservation* const reader : readers) check_type(topic, *reader, "reads", findings);
    for (const EndpointObservation* const writer : writers) {
      for (const EndpointObservation* const reader : readers) check_pair(topic, *writer, *reader, findings);
    }
  }
  check_partitions(observations, findings);
}

bool no_fusion_receives_imu(const Observations& observations) {
  const auto pose_writers = on_topic(observations.writers, "sonopose/pose");
  const auto imu_writers = on_topic(observations.writers, "sonopose/imu");
  bool has_fusion = false;
  for (const EndpointObservation* const reader : on_topic(observations.readers, "sonopose/imu")) {
    const bool is_fusion =
        std::any_of(pose_writers.begin(), pose_writers.end(),
                    [&](const EndpointObservation* writer) { return writer->process == reader->process; });
    if (!is_fusion) continue;
    has_fusion = true;
    const bool receives =
        std::any_of(imu_writers.begin(), imu_writers.end(),
                    [&](const EndpointObservation* writer) { return !is_mismatch(*writer, *reader); });
    if (receives) return false;
  }
  return has_fusion;
}

void check_pose_writers(const Observations& observations, Findings& findings) {
  for (const auto& problem : observation::problems_of(observations.pose_writers)) {
    findings.push_back({problem.foreign ? Severity::error : Severity::warning, "sonopose/pose", problem.what,
                        problem.remedy});
  }
}

}  // namespace sonopose::doctor::rules
