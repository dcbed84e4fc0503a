#pragma once
/// \file
/// Additions of sonopose to the PSM, as free functions.

#include "dds/domain/ddsdomain.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <dds/dds.h>

namespace sonopose::dds::ext {

/// The handle of an entity or condition in C, for calls that the PSM lacks.
inline dds_entity_t handle(const ::dds::core::Reference& entity) {
  return ::dds::core::detail::Access::handle(entity);
}

/// Joins a domain with these options: other networks than loopback, peers, security. Publishers and
/// subscribers have the partition of the options by default.
::dds::domain::DomainParticipant participant(const DomainOptions& options,
                                             const ::dds::domain::qos::DomainParticipantQos& qos = {});

}  // namespace sonopose::dds::ext
