#pragma once
/// \file
/// A set of QoS policies for any entity. Unset policies have the DDS default.

#include <sonopose/dds/binding/policy.hpp>

#include <dds/dds.h>

#include <memory>
#include <optional>

namespace sonopose::dds {

/// A value: copies are independent. Usage: `qos << policy::Deadline{…} << policy::History::keep_last(64)`.
class Qos {
public:
  Qos();
  Qos(const Qos& other);
  Qos& operator=(const Qos& other);
  Qos(Qos&&) noexcept = default;
  Qos& operator=(Qos&&) noexcept = default;
  ~Qos() = default;

  /// Sets one policy. Throws std::invalid_argument for an invalid value.
  template <class Policy>
  Qos& operator<<(const Policy& value) {
    value.apply(qos_.get());
    return *this;
  }

  /// The policy; empty if it is not set.
  template <class Policy>
  std::optional<Policy> policy() const {
    return Policy::from(qos_.get());
  }

  /// Sets every policy that `over` sets, and keeps the others.
  void merge(const Qos& over);

  dds_qos_t* get() noexcept { return qos_.get(); }
  const dds_qos_t* get() const noexcept { return qos_.get(); }

private:
  struct Delete {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
  };
  std::unique_ptr<dds_qos_t, Delete> qos_;
};

/// Period of the deadline; infinite, the DDS default, if it is not set.
inline Duration deadline_of(const Qos& qos) {
  return qos.policy<policy::Deadline>().value_or(policy::Deadline{}).period;
}

}  // namespace sonopose::dds
