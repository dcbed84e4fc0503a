#include <sonopose/dds/binding/policy.hpp>

#include <dds/dds.h>

#include <stdexcept>

namespace sonopose::dds::policy {
namespace {

void require(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

bool is_limit(std::int32_t value) {
  return value > 0 || value == length_unlimited;
}

/// Reads a policy that consists of one duration.
template <class Policy>
std::optional<Policy> duration_policy(bool (*get)(const dds_qos_t*, dds_duration_t*), const dds_qos_t* qos) {
  dds_duration_t value = 0;
  if (!get(qos, &value)) return std::nullopt;
  return Policy{Duration(value)};
}

}  // namespace

void Deadline::apply(dds_qos_t* qos) const {
  require(period > Duration::zero(), "a deadline must be positive");
  dds_qset_deadline(qos, period.count());
}
std::optional<Deadline> Deadline::from(const dds_qos_t* qos) {
  return duration_policy<Deadline>(dds_qget_deadline, qos);
}

void LatencyBudget::apply(dds_qos_t* qos) const {
  require(duration >= Duration::zero(), "a latency budget must not be negative");
  dds_qset_latency_budget(qos, duration.count());
}
std::optional<LatencyBudget> LatencyBudget::from(const dds_qos_t* qos) {
  return duration_policy<LatencyBudget>(dds_qget_latency_budget, qos);
}

void Lifespan::apply(dds_qos_t* qos) const {
  require(duration > Duration::zero(), "a lifespan must be positive");
  dds_qset_lifespan(qos, duration.count());
}
std::optional<Lifespan> Lifespan::from(const dds_qos_t* qos) {
  return duration_policy<Lifespan>(dds_qget_lifespan, qos);
}

void Reliability::apply(dds_qos_t* qos) const {
  require(max_blocking_time >= Duration::zero(), "a maximum blocking time must not be negative");
  dds_qset_reliability(
      qos, kind == ReliabilityKind::reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
      max_blocking_time.count());
}
std::optional<Reliability> Reliability::from(const dds_qos_t* qos) {
  dds_reliability_kind_t kind{};
  dds_duration_t blocking = 0;
  if (!dds_qget_reliability(qos, &kind, &blocking)) return std::nullopt;
  return Reliability{
      kind == DDS_RELIABILITY_RELIABLE ? ReliabilityKind::reliable : ReliabilityKind::best_effort,
      Duration(blocking)};
}

void History::apply(dds_qos_t* qos) const {
  require(depth > 0, "a history depth must be positive");
  dds_qset_history(qos, kind == HistoryKind::keep_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST, depth);
}
std::optional<History> History::from(const dds_qos_t* qos) {
  dds_history_kind_t kind{};
  std::int32_t depth = 0;
  if (!dds_qget_history(qos, &kind, &depth)) return std::nullopt;
  return History{kind == DDS_HISTORY_KEEP_ALL ? HistoryKind::keep_all : HistoryKind::keep_last, depth};
}

void Durability::apply(dds_qos_t* qos) const {
  dds_qset_durability(qos, kind == DurabilityKind::transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL
                                                                   : DDS_DURABILITY_VOLATILE);
}
std::optional<Durability> Durability::from(const dds_qos_t* qos) {
  dds_durability_kind_t kind{};
  if (!dds_qget_durability(qos, &kind)) return std::nullopt;
  return Durability{kind == DDS_DURABILITY_VOLATILE ? DurabilityKind::volatile_data
                                                    : DurabilityKind::transient_local};
}

void Liveliness::apply(dds_qos_t* qos) const {
  require(lease_duration > Duration::zero(), "a liveliness lease must be positive");
  dds_qset_liveliness(qos, static_cast<dds_liveliness_kind_t>(kind), lease_duration.count());
}
std::optional<Liveliness> Liveliness::from(const dds_qos_t* qos) {
  dds_liveliness_kind_t kind{};
  dds_duration_t lease = 0;
  if (!dds_qget_liveliness(qos, &kind, &lease)) return std::nullopt;
  return Liveliness{static_cast<LivelinessKind>(kind), Duration(lease)};
}
static_assert(static_cast<int>(LivelinessKind::automatic) == DDS_LIVELINESS_AUTOMATIC);
static_assert(static_cast<int>(LivelinessKind::manual_by_participant) ==
              DDS_LIVELINESS_MANUAL_BY_PARTICIPANT);
static_assert(static_cast<int>(LivelinessKind::manual_by_topic) == DDS_LIVELINESS_MANUAL_BY_TOPIC);

void Ownership::apply(dds_qos_t* qos) const {
  dds_qset_ownership(qos, kind == OwnershipKind::exclusive ? DDS_OWNERSHIP_EXCLUSIVE : DDS_OWNERSHIP_SHARED);
}
std::optional<Ownership> Ownership::from(const dds_qos_t* qos) {
  dds_ownership_kind_t kind{};
  if (!dds_qget_ownership(qos, &kind)) return std::nullopt;
  return Ownership{kind == DDS_OWNERSHIP_EXCLUSIVE ? OwnershipKind::exclusive : OwnershipKind::shared};
}

void OwnershipStrength::apply(dds_qos_t* qos) const {
  dds_qset_ownership_strength(qos, value);
}
std::optional<OwnershipStrength> OwnershipStrength::from(const dds_qos_t* qos) {
  OwnershipStrength strength;
  if (!dds_qget_ownership_strength(qos, &strength.value)) return std::nullopt;
  return strength;
}

void ResourceLimits::apply(dds_qos_t* qos) const {
  require(is_limit(max_samples) && is_limit(max_instances) && is_limit(max_samples_per_instance),
          "a resource limit must be positive or unlimited");
  dds_qset_resource_limits(qos, max_samples, max_instances, max_samples_per_instance);
}
std::optional<ResourceLimits> ResourceLimits::from(const dds_qos_t* qos) {
  ResourceLimits limits;
  if (!dds_qget_resource_limits(qos, &limits.max_samples, &limits.max_instances,
                                &limits.max_samples_per_instance)) {
    return std::nullopt;
  }
  return limits;
}

void DurabilityService::apply(dds_qos_t* qos) const {
  require(history_depth > 0, "a history depth must be positive");
  dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, history_depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
}
std::optional<DurabilityService> DurabilityService::from(const dds_qos_t* qos) {
  DurabilityService service;
  if (!dds_qget_durability_service(qos, nullptr, nullptr, &service.history_depth, nullptr, nullptr,
                                   nullptr)) {
    return std::nullopt;
  }
  return service;
}

void TransportPriority::apply(dds_qos_t* qos) const {
  dds_qset_transport_priority(qos, value);
}
std::optional<TransportPriority> TransportPriority::from(const dds_qos_t* qos) {
  TransportPriority priority;
  if (!dds_qget_transport_priority(qos, &priority.value)) return std::nullopt;
  return priority;
}

void WriterDataLifecycle::apply(dds_qos_t* qos) const {
  dds_qset_writer_data_lifecycle(qos, autodispose_unregistered_instances);
}
std::optional<WriterDataLifecycle> WriterDataLifecycle::from(const dds_qos_t* qos) {
  WriterDataLifecycle lifecycle;
  if (!dds_qget_writer_data_lifecycle(qos, &lifecycle.autodispose_unregistered_instances))
    return std::nullopt;
  return lifecycle;
}

void Partition::apply(dds_qos_t* qos) const {
  std::vector<const char*> pointers;
  pointers.reserve(names.size());
  for (const std::string& name : names) pointers.push_back(name.c_str());
  dds_qset_partition(qos, static_cast<std::uint32_t>(pointers.size()), pointers.data());
}
std::optional<Partition> Partition::from(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  char** names = nullptr;
  if (!dds_qget_partition(qos, &count, &names)) return std::nullopt;
  Partition partition;
  for (std::uint32_t i = 0; i < count; ++i) {
    partition.names.emplace_back(names[i]);
    dds_free(names[i]);
  }
  dds_free(names);
  return partition;
}

void UserData::apply(dds_qos_t* qos) const {
  dds_qset_userdata(qos, value.data(), value.size());
}
std::optional<UserData> UserData::from(const dds_qos_t* qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &bytes, &size)) return std::nullopt;
  UserData data;
  if (size > 0) {
    const auto* first = static_cast<const std::uint8_t*>(bytes);
    data.value.assign(first, first + size);
  }
  dds_free(bytes);
  return data;
}

}  // namespace sonopose::dds::policy
