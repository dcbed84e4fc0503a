#pragma once
/// \file
/// QoS of which some policies are unset, as in profiles and in what discovery finds. The PSM has no such
/// type.

#include "dds/core/detail/EntityQos.hpp"
#include <sonopose/dds/psm/names.hpp>

#include <dds/dds.h>

#include <optional>

namespace sonopose::dds {

/// Policies of the PSM for an entity of any kind. Converts to the QoS of each kind, which takes from the
/// topic what is unset. Usage: `qos << Deadline(…) << History::KeepLast(64)`.
class Qos {
public:
  Qos() = default;
  explicit Qos(const dds_qos_t* qos) : qos_(core::detail::copy_of(qos)) {}
  Qos(const Qos& other) : Qos(other.get()) {}
  Qos& operator=(const Qos& other) {
    qos_ = core::detail::copy_of(other.get());
    return *this;
  }
  Qos(Qos&&) noexcept = default;
  Qos& operator=(Qos&&) noexcept = default;
  ~Qos() = default;

  /// Sets one policy. Throws the exceptions of the PSM for an invalid value.
  template <class Policy>
  Qos& operator<<(const Policy& value) {
    core::detail::apply(value, get());
    return *this;
  }

  /// The policy; empty if it is not set.
  template <class Policy>
  std::optional<Policy> policy() const {
    Policy value;
    return core::detail::read(value, get()) ? std::optional(value) : std::nullopt;
  }
  /// The policy; its default if it is not set.
  template <class Policy>
  Policy policy_or_default() const {
    return policy<Policy>().value_or(Policy());
  }

  /// Sets every policy that `over` sets, and keeps the others.
  void merge(const Qos& over);

  template <class Defaults, class... Policies>
  operator core::detail::EntityQos<Defaults, Policies...>() const {
    return core::detail::EntityQos<Defaults, Policies...>::of_c(get());
  }

  dds_qos_t* get() noexcept { return qos_.get(); }
  const dds_qos_t* get() const noexcept { return qos_.get(); }

private:
  core::detail::CQos qos_ = core::detail::make_qos();
};

}  // namespace sonopose::dds
