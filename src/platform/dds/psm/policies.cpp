// Policies in C. Their limits are those that Cyclone DDS does not check itself.

#include <sonopose/dds/psm/dds/core/detail/EntityQos.hpp>
#include <sonopose/dds/psm/qos.hpp>

#include <algorithm>
#include <new>
#include <string>
#include <vector>

namespace dds::inline sonopose_psm::core::detail {
namespace {

template <class Exception = InvalidArgumentError>
void require(bool ok, const char* what) {
  if (!ok) throw Exception(what);
}

bool is_limit(std::int32_t value) {
  return value > 0 || value == LENGTH_UNLIMITED;
}

/// The QoS of others may have negative durations, which become zero.
Duration read_duration(dds_duration_t ns) {
  return to_duration(std::max<dds_duration_t>(ns, 0));
}

/// The kinds have the same numbers in C.
template <class Kind>
Kind kind_of(auto c_kind) {
  return static_cast<Kind>(static_cast<int>(c_kind));
}
static_assert(policy::DurabilityKind::TRANSIENT_LOCAL == int{DDS_DURABILITY_TRANSIENT_LOCAL});
static_assert(policy::OwnershipKind::EXCLUSIVE == int{DDS_OWNERSHIP_EXCLUSIVE});
static_assert(policy::ReliabilityKind::RELIABLE == int{DDS_RELIABILITY_RELIABLE});
static_assert(policy::HistoryKind::KEEP_ALL == int{DDS_HISTORY_KEEP_ALL});
static_assert(policy::LivelinessKind::MANUAL_BY_PARTICIPANT == int{DDS_LIVELINESS_MANUAL_BY_PARTICIPANT});
static_assert(policy::LivelinessKind::MANUAL_BY_TOPIC == int{DDS_LIVELINESS_MANUAL_BY_TOPIC});

}  // namespace

CQos make_qos() {
  CQos qos(dds_create_qos());
  if (!qos) throw std::bad_alloc();
  return qos;
}

CQos copy_of(const dds_qos_t* qos) {
  CQos copy = make_qos();
  if (qos != nullptr) check("dds_copy_qos", dds_copy_qos(copy.get(), qos));
  return copy;
}

void apply(const policy::UserData& policy, dds_qos_t* qos) {
  const ByteSeq value = policy.value();
  dds_qset_userdata(qos, value.data(), value.size());
}
bool read(policy::UserData& policy, const dds_qos_t* qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &bytes, &size)) return false;
  const auto* const first = static_cast<const std::uint8_t*>(bytes);
  policy.value(first == nullptr ? ByteSeq() : ByteSeq(first, first + size));
  dds_free(bytes);
  return true;
}

void apply(const policy::Durability& policy, dds_qos_t* qos) {
  dds_qset_durability(qos, kind_of<dds_durability_kind_t>(policy.kind()));
}
bool read(policy::Durability& policy, const dds_qos_t* qos) {
  dds_durability_kind_t kind{};
  if (!dds_qget_durability(qos, &kind)) return false;
  policy.kind(kind == DDS_DURABILITY_VOLATILE ? policy::DurabilityKind::VOLATILE
                                              : policy::DurabilityKind::TRANSIENT_LOCAL);
  return true;
}

void apply(const policy::Deadline& policy, dds_qos_t* qos) {
  require(policy.period() > Duration::zero(), "a deadline must be positive");  // Cyclone DDS crashes at zero
  dds_qset_deadline(qos, to_c(policy.period()));
}
bool read(policy::Deadline& policy, const dds_qos_t* qos) {
  dds_duration_t period = 0;
  if (!dds_qget_deadline(qos, &period)) return false;
  policy.period(read_duration(period));
  return true;
}

void apply(const policy::LatencyBudget& policy, dds_qos_t* qos) {
  dds_qset_latency_budget(qos, to_c(policy.duration()));
}
bool read(policy::LatencyBudget& policy, const dds_qos_t* qos) {
  dds_duration_t duration = 0;
  if (!dds_qget_latency_budget(qos, &duration)) return false;
  policy.duration(read_duration(duration));
  return true;
}

void apply(const policy::Lifespan& policy, dds_qos_t* qos) {
  require(policy.duration() > Duration::zero(), "a lifespan must be positive");
  dds_qset_lifespan(qos, to_c(policy.duration()));
}
bool read(policy::Lifespan& policy, const dds_qos_t* qos) {
  dds_duration_t duration = 0;
  if (!dds_qget_lifespan(qos, &duration)) return false;
  policy.duration(read_duration(duration));
  return true;
}

void apply(const policy::Ownership& policy, dds_qos_t* qos) {
  dds_qset_ownership(qos, kind_of<dds_ownership_kind_t>(policy.kind()));
}
bool read(policy::Ownership& policy, const dds_qos_t* qos) {
  dds_ownership_kind_t kind{};
  if (!dds_qget_ownership(qos, &kind)) return false;
  policy.kind(kind_of<policy::OwnershipKind::Type>(kind));
  return true;
}

void apply(const policy::OwnershipStrength& policy, dds_qos_t* qos) {
  dds_qset_ownership_strength(qos, policy.value());
}
bool read(policy::OwnershipStrength& policy, const dds_qos_t* qos) {
  std::int32_t strength = 0;
  if (!dds_qget_ownership_strength(qos, &strength)) return false;
  policy.value(strength);
  return true;
}

void apply(const policy::Liveliness& policy, dds_qos_t* qos) {
  require(policy.lease_duration() > Duration::zero(), "a liveliness lease must be positive");
  dds_qset_liveliness(qos, kind_of<dds_liveliness_kind_t>(policy.kind()), to_c(policy.lease_duration()));
}
bool read(policy::Liveliness& policy, const dds_qos_t* qos) {
  dds_liveliness_kind_t kind{};
  dds_duration_t lease = 0;
  if (!dds_qget_liveliness(qos, &kind, &lease)) return false;
  policy.kind(kind_of<policy::LivelinessKind::Type>(kind)).lease_duration(read_duration(lease));
  return true;
}

void apply(const policy::Partition& policy, dds_qos_t* qos) {
  const StringSeq names = policy.name();
  std::vector<const char*> pointers;
  for (const std::string& name : names) pointers.push_back(name.c_str());
  dds_qset_partition(qos, static_cast<std::uint32_t>(pointers.size()), pointers.data());
}
bool read(policy::Partition& policy, const dds_qos_t* qos) {
  std::uint32_t count = 0;
  char** names = nullptr;
  if (!dds_qget_partition(qos, &count, &names)) return false;
  policy.name(StringSeq(names, names + count));
  for (std::uint32_t i = 0; i < count; ++i) dds_free(names[i]);
  dds_free(names);
  return true;
}

void apply(const policy::Reliability& policy, dds_qos_t* qos) {
  dds_qset_reliability(qos, kind_of<dds_reliability_kind_t>(policy.kind()), to_c(policy.max_blocking_time()));
}
bool read(policy::Reliability& policy, const dds_qos_t* qos) {
  dds_reliability_kind_t kind{};
  dds_duration_t blocking = 0;
  if (!dds_qget_reliability(qos, &kind, &blocking)) return false;
  policy.kind(kind_of<policy::ReliabilityKind::Type>(kind)).max_blocking_time(read_duration(blocking));
  return true;
}

void apply(const policy::History& policy, dds_qos_t* qos) {
  const bool keeps_all = policy.kind() == policy::HistoryKind::KEEP_ALL;
  // The exception is that of cyclonedds-cxx.
  require<InconsistentPolicyError>(keeps_all || policy.depth() > 0, "a history depth must be positive");
  dds_qset_history(qos, kind_of<dds_history_kind_t>(policy.kind()), std::max(1, policy.depth()));
}
bool read(policy::History& policy, const dds_qos_t* qos) {
  dds_history_kind_t kind{};
  std::int32_t depth = 0;
  if (!dds_qget_history(qos, &kind, &depth)) return false;
  policy.kind(kind_of<policy::HistoryKind::Type>(kind)).depth(depth);
  return true;
}

void apply(const policy::ResourceLimits& policy, dds_qos_t* qos) {
  require(is_limit(policy.max_samples()) && is_limit(policy.max_instances()) &&
              is_limit(policy.max_samples_per_instance()),
          "a resource limit must be positive or unlimited");
  dds_qset_resource_limits(qos, policy.max_samples(), policy.max_instances(),
                           policy.max_samples_per_instance());
}
bool read(policy::ResourceLimits& policy, const dds_qos_t* qos) {
  std::int32_t samples = 0;
  std::int32_t instances = 0;
  std::int32_t samples_per_instance = 0;
  if (!dds_qget_resource_limits(qos, &samples, &instances, &samples_per_instance)) return false;
  policy = policy::ResourceLimits(samples, instances, samples_per_instance);
  return true;
}

void apply(const policy::WriterDataLifecycle& policy, dds_qos_t* qos) {
  dds_qset_writer_data_lifecycle(qos, policy.autodispose_unregistered_instances());
}
bool read(policy::WriterDataLifecycle& policy, const dds_qos_t* qos) {
  bool autodispose = true;
  if (!dds_qget_writer_data_lifecycle(qos, &autodispose)) return false;
  policy.autodispose_unregistered_instances(autodispose);
  return true;
}

void apply(const policy::TransportPriority& policy, dds_qos_t* qos) {
  dds_qset_transport_priority(qos, policy.value());
}
bool read(policy::TransportPriority& policy, const dds_qos_t* qos) {
  std::int32_t priority = 0;
  if (!dds_qget_transport_priority(qos, &priority)) return false;
  policy.value(priority);
  return true;
}

void apply(const policy::DurabilityService& policy, dds_qos_t* qos) {
  require(policy.history_depth() > 0, "a history depth must be positive");
  dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, policy.history_depth(), DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
}
bool read(policy::DurabilityService& policy, const dds_qos_t* qos) {
  std::int32_t depth = 0;
  if (!dds_qget_durability_service(qos, nullptr, nullptr, &depth, nullptr, nullptr, nullptr)) return false;
  policy.history_depth(depth);
  return true;
}

}  // namespace dds::inline sonopose_psm::core::detail

namespace sonopose::dds {

void Qos::merge(const Qos& over) {
  // dds_merge_qos sets only policies that its first argument lacks.
  Qos merged(over);
  dds_merge_qos(merged.get(), get());
  *this = std::move(merged);
}

}  // namespace sonopose::dds
