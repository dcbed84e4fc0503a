#pragma once
/// \file
/// A process's membership in a DDS domain.

#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/binding/entity.hpp>
#include <sonopose/dds/binding/qos.hpp>

#include <string>

namespace sonopose::dds {

/// Joins the domain, which is configured when its first participant in this process comes and closed after
/// the last one. Topics, writers and readers of a participant must not outlive it.
class DomainParticipant : private DomainLease, public Entity {
public:
  explicit DomainParticipant(const DomainOptions& options = {}, const Qos& qos = {});

  DomainParticipant(const DomainParticipant&) = delete;
  DomainParticipant& operator=(const DomainParticipant&) = delete;
  DomainParticipant(DomainParticipant&&) noexcept = default;
  DomainParticipant& operator=(DomainParticipant&& other) noexcept;
  ~DomainParticipant() = default;

  using DomainLease::domain_id;

  /// Of the options: what make_writer and make_reader add to every profile.
  [[nodiscard]] const std::string& partition() const noexcept { return partition_; }

private:
  std::string partition_;
};

/// As the constructor: the one line by which an application joins.
inline DomainParticipant make_participant(const DomainOptions& options = {}, const Qos& qos = {}) {
  return DomainParticipant(options, qos);
}

}  // namespace sonopose::dds
