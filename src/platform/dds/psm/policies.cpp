// Policies, by those of the C++ layer below, which validate them.

#include <sonopose/dds/binding/policy.hpp>
#include <sonopose/dds/psm/dds/core/detail/EntityQos.hpp>

#include <chrono>
#include <new>
#include <stdexcept>

namespace dds::inline sonopose_psm::core::detail {
namespace {

namespace own = sonopose::dds::policy;

std::chrono::nanoseconds to_chrono(const Duration& duration) {
  return std::chrono::nanoseconds(to_c(duration));
}

template <class Policy>
void apply_valid(const Policy& policy, dds_qos_t* qos) try {
  policy.apply(qos);
} catch (const std::invalid_argument& error) {
  throw InvalidArgumentError(error.what());
}

}  // namespace

CQos make_qos() {
  CQos qos(dds_create_qos());
  if (!qos) throw std::bad_alloc();
  return qos;
}

void apply(const policy::UserData& policy, dds_qos_t* qos) {
  apply_valid(own::UserData{policy.value()}, qos);
}
void apply(const policy::Durability& policy, dds_qos_t* qos) {
  apply_valid(own::Durability{static_cast<own::DurabilityKind>(policy.kind())}, qos);
}
static_assert(static_cast<int>(own::DurabilityKind::transient_local) ==
              policy::DurabilityKind::TRANSIENT_LOCAL);
void apply(const policy::Deadline& policy, dds_qos_t* qos) {
  apply_valid(own::Deadline{to_chrono(policy.period())}, qos);
}
void apply(const policy::LatencyBudget& policy, dds_qos_t* qos) {
  apply_valid(own::LatencyBudget{to_chrono(policy.duration())}, qos);
}
void apply(const policy::Lifespan& policy, dds_qos_t* qos) {
  apply_valid(own::Lifespan{to_chrono(policy.duration())}, qos);
}
void apply(const policy::Ownership& policy, dds_qos_t* qos) {
  apply_valid(own::Ownership{static_cast<own::OwnershipKind>(policy.kind())}, qos);
}
static_assert(static_cast<int>(own::OwnershipKind::exclusive) == policy::OwnershipKind::EXCLUSIVE);
void apply(const policy::OwnershipStrength& policy, dds_qos_t* qos) {
  apply_valid(own::OwnershipStrength{policy.value()}, qos);
}
void apply(const policy::Liveliness& policy, dds_qos_t* qos) {
  apply_valid(
      own::Liveliness{static_cast<own::LivelinessKind>(policy.kind()), to_chrono(policy.lease_duration())},
      qos);
}
static_assert(static_cast<int>(own::LivelinessKind::manual_by_topic) ==
              policy::LivelinessKind::MANUAL_BY_TOPIC);
void apply(const policy::Partition& policy, dds_qos_t* qos) {
  apply_valid(own::Partition{policy.name()}, qos);
}
void apply(const policy::Reliability& policy, dds_qos_t* qos) {
  apply_valid(own::Reliability{static_cast<own::ReliabilityKind>(policy.kind()),
                               to_chrono(policy.max_blocking_time())},
              qos);
}
static_assert(static_cast<int>(own::ReliabilityKind::reliable) == policy::ReliabilityKind::RELIABLE);
void apply(const policy::History& policy, dds_qos_t* qos) {
  if (policy.kind() == policy::HistoryKind::KEEP_ALL) return apply_valid(own::History::keep_all(), qos);
  if (policy.depth() <= 0) throw InconsistentPolicyError("a history depth must be positive");
  apply_valid(own::History::keep_last(policy.depth()), qos);
}
void apply(const policy::ResourceLimits& policy, dds_qos_t* qos) {
  apply_valid(
      own::ResourceLimits{policy.max_samples(), policy.max_instances(), policy.max_samples_per_instance()},
      qos);
}
void apply(const policy::WriterDataLifecycle& policy, dds_qos_t* qos) {
  apply_valid(own::WriterDataLifecycle{policy.autodispose_unregistered_instances()}, qos);
}
void apply(const policy::TransportPriority& policy, dds_qos_t* qos) {
  apply_valid(own::TransportPriority{policy.value()}, qos);
}
void apply(const policy::DurabilityService& policy, dds_qos_t* qos) {
  apply_valid(own::DurabilityService{policy.history_depth()}, qos);
}

}  // namespace dds::inline sonopose_psm::core::detail
