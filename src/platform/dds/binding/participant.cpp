#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/participant.hpp>

#include <utility>

namespace sonopose::dds {

DomainParticipant::DomainParticipant(const DomainOptions& options, const Qos& qos)
    : DomainLease(options),
      Entity(check("dds_create_participant", "domain " + std::to_string(domain_id()),
                   dds_create_participant(domain_id(), qos.get(), nullptr))),
      partition_(options.partition) {}

DomainParticipant& DomainParticipant::operator=(DomainParticipant&& other) noexcept {
  // Delete the old participant before releasing its reference to the domain.
  Entity::operator=(std::move(static_cast<Entity&>(other)));
  DomainLease::operator=(std::move(static_cast<DomainLease&>(other)));
  partition_ = std::move(other.partition_);
  return *this;
}

}  // namespace sonopose::dds
