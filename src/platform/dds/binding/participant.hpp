#pragma once
/// \file
/// A process's membership in a domain.

#include <sonopose/dds/binding/domain.hpp>

#include <dds/dds.h>

#include <cstdint>

namespace sonopose::dds {

/// A participant in C. The first one of a process configures the domain, the last one closes it.
class Membership {
public:
  /// Adds the security of the options to `qos`. Throws `Error`.
  Membership(const DomainOptions& options, dds_qos_t* qos);
  Membership(const Membership&) = delete;
  Membership& operator=(const Membership&) = delete;
  ~Membership();

  std::uint32_t domain_id() const noexcept { return lease_.domain_id(); }
  dds_entity_t handle() const noexcept { return handle_; }

private:
  DomainLease lease_;
  dds_entity_t handle_;
};

}  // namespace sonopose::dds
