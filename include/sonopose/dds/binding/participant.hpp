#pragma once
/// \file
/// A participant: a process's membership in a DDS domain.

#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/binding/entity.hpp>
#include <sonopose/dds/binding/qos.hpp>

#include <string>

namespace sonopose::dds {

/// Joins the domain. The first participant of a process configures the domain, the last one closes it. A
/// participant must outlive its topics, writers and readers.
class DomainParticipant : private DomainLease, public Entity {
public:
  explicit DomainParticipant(const DomainOptions& options = {}, const Qos& qos = {});

  DomainParticipant(const DomainParticipant&) = delete;
  DomainParticipant& operator=(const DomainParticipant&) = delete;
  DomainParticipant(DomainParticipant&&) noexcept = default;
  DomainParticipant& operator=(DomainParticipant&& other) noexcept;
  ~DomainParticipant() = default;

  using DomainLease::domain_id;

  /// Partition of the options. topics::make_writer and topics::make_reader add it to every profile.
  [[nodiscard]] const std::string& partition() const noexcept { return partition_; }

private:
  std::string partition_;
};

/// Equivalent to the constructor.
inline DomainParticipant make_participant(const DomainOptions& options = {}, const Qos& qos = {}) {
  return DomainParticipant(options, qos);
}

}  // namespace sonopose::dds
