#pragma once
/// \file
/// QoS policies, as values. A setter returns the policy itself. Invalid values are refused when the policy is
/// put into a QoS: InconsistentPolicyError for a history, otherwise InvalidArgumentError. Left out:
/// DataRepresentation, DestinationOrder, EntityFactory, GroupData, Presentation, ReaderDataLifecycle,
/// TimeBasedFilter, TopicData, TypeConsistencyEnforcement, policy_name, and the durabilities TRANSIENT and
/// PERSISTENT.

#include "../Time.hpp"
#include "../status/Status.hpp"
#include "../types.hpp"

#include <dds/dds.h>

#include <cstdint>
#include <string>
#include <utility>

namespace dds::inline sonopose_psm::core::policy {

struct OwnershipKind {
  OwnershipKind() = delete;
  enum Type { SHARED, EXCLUSIVE };
};
struct DurabilityKind {
  DurabilityKind() = delete;
  enum Type { VOLATILE, TRANSIENT_LOCAL };
};
struct ReliabilityKind {
  ReliabilityKind() = delete;
  enum Type { BEST_EFFORT, RELIABLE };
};
struct HistoryKind {
  HistoryKind() = delete;
  enum Type { KEEP_LAST, KEEP_ALL };
};
struct LivelinessKind {
  LivelinessKind() = delete;
  enum Type { AUTOMATIC, MANUAL_BY_PARTICIPANT, MANUAL_BY_TOPIC };
};

/// Bytes that discovery sends to all matched endpoints.
class UserData {
public:
  UserData() = default;
  explicit UserData(ByteSeq bytes) : value_(std::move(bytes)) {}
  UserData(const std::uint8_t* first, const std::uint8_t* last) : value_(first, last) {}
  UserData& value(const ByteSeq& bytes) {
    value_ = bytes;
    return *this;
  }
  const ByteSeq value() const { return value_; }
  bool operator==(const UserData&) const = default;

private:
  ByteSeq value_;
};

/// Delivery of samples to readers that appeared after they were written.
class Durability {
public:
  explicit Durability(DurabilityKind::Type kind = DurabilityKind::VOLATILE) : kind_(kind) {}
  static Durability Volatile() { return Durability(DurabilityKind::VOLATILE); }
  static Durability TransientLocal() { return Durability(DurabilityKind::TRANSIENT_LOCAL); }
  DurabilityKind::Type kind() const { return kind_; }
  Durability& kind(DurabilityKind::Type kind) {
    kind_ = kind;
    return *this;
  }
  bool operator==(const Durability&) const = default;

private:
  DurabilityKind::Type kind_;
};

/// Maximum time between two samples of an instance. Positive.
class Deadline {
public:
  explicit Deadline(const Duration& period = Duration::infinite()) : period_(period) {}
  const Duration period() const { return period_; }
  Deadline& period(const Duration& period) {
    period_ = period;
    return *this;
  }
  bool operator==(const Deadline&) const = default;

private:
  Duration period_;
};

/// Maximum delay of a sample to send it together with others.
class LatencyBudget {
public:
  explicit LatencyBudget(const Duration& duration = Duration::zero()) : duration_(duration) {}
  const Duration duration() const { return duration_; }
  LatencyBudget& duration(const Duration& duration) {
    duration_ = duration;
    return *this;
  }
  bool operator==(const LatencyBudget&) const = default;

private:
  Duration duration_;
};

/// Time for which a sample is useful after its source time stamp. Positive.
class Lifespan {
public:
  explicit Lifespan(const Duration& duration = Duration::infinite()) : duration_(duration) {}
  const Duration duration() const { return duration_; }
  Lifespan& duration(const Duration& duration) {
    duration_ = duration;
    return *this;
  }
  bool operator==(const Lifespan&) const = default;

private:
  Duration duration_;
};

/// Exclusive or shared ownership of an instance. The two never match.
class Ownership {
public:
  explicit Ownership(OwnershipKind::Type kind = OwnershipKind::SHARED) : kind_(kind) {}
  static Ownership Exclusive() { return Ownership(OwnershipKind::EXCLUSIVE); }
  static Ownership Shared() { return Ownership(OwnershipKind::SHARED); }
  OwnershipKind::Type kind() const { return kind_; }
  Ownership& kind(OwnershipKind::Type kind) {
    kind_ = kind;
    return *this;
  }
  bool operator==(const Ownership&) const = default;

private:
  OwnershipKind::Type kind_;
};

/// The writer with the highest strength owns the instance.
class OwnershipStrength {
public:
  explicit OwnershipStrength(std::int32_t strength = 0) : value_(strength) {}
  std::int32_t value() const { return value_; }
  OwnershipStrength& value(std::int32_t strength) {
    value_ = strength;
    return *this;
  }
  bool operator==(const OwnershipStrength&) const = default;

private:
  std::int32_t value_;
};

/// Assertion of a writer's liveliness, and the lease after which it counts as dead. The lease is positive.
class Liveliness {
public:
  Liveliness(LivelinessKind::Type kind = LivelinessKind::AUTOMATIC,
             const Duration& lease_duration = Duration::infinite())
      : kind_(kind), lease_duration_(lease_duration) {}
  static Liveliness Automatic(const Duration& lease_duration = Duration::infinite()) {
    return {LivelinessKind::AUTOMATIC, lease_duration};
  }
  static Liveliness ManualByParticipant(const Duration& lease_duration = Duration::infinite()) {
    return {LivelinessKind::MANUAL_BY_PARTICIPANT, lease_duration};
  }
  static Liveliness ManualByTopic(const Duration& lease_duration = Duration::infinite()) {
    return {LivelinessKind::MANUAL_BY_TOPIC, lease_duration};
  }
  LivelinessKind::Type kind() const { return kind_; }
  Liveliness& kind(LivelinessKind::Type kind) {
    kind_ = kind;
    return *this;
  }
  const Duration lease_duration() const { return lease_duration_; }
  Liveliness& lease_duration(const Duration& lease_duration) {
    lease_duration_ = lease_duration;
    return *this;
  }
  bool operator==(const Liveliness&) const = default;

private:
  LivelinessKind::Type kind_;
  Duration lease_duration_;
};

/// Reader and writer match only if they share a partition.
class Partition {
public:
  explicit Partition(const std::string& name = "") : name_{name} {}
  explicit Partition(StringSeq names) : name_(std::move(names)) {}
  const StringSeq name() const { return name_; }
  Partition& name(const std::string& name) {
    name_ = {name};
    return *this;
  }
  Partition& name(const StringSeq& names) {
    name_ = names;
    return *this;
  }
  bool operator==(const Partition&) const = default;

private:
  StringSeq name_;
};

/// Repetition of lost samples, and the longest time that a write may block.
class Reliability {
public:
  Reliability(ReliabilityKind::Type kind = ReliabilityKind::BEST_EFFORT,
              const Duration& max_blocking_time = Duration::from_millisecs(100))
      : kind_(kind), max_blocking_time_(max_blocking_time) {}
  static Reliability Reliable(const Duration& max_blocking_time = Duration::from_millisecs(100)) {
    return {ReliabilityKind::RELIABLE, max_blocking_time};
  }
  static Reliability BestEffort(const Duration& max_blocking_time = Duration::from_millisecs(100)) {
    return {ReliabilityKind::BEST_EFFORT, max_blocking_time};
  }
  ReliabilityKind::Type kind() const { return kind_; }
  Reliability& kind(ReliabilityKind::Type kind) {
    kind_ = kind;
    return *this;
  }
  const Duration max_blocking_time() const { return max_blocking_time_; }
  Reliability& max_blocking_time(const Duration& max_blocking_time) {
    max_blocking_time_ = max_blocking_time;
    return *this;
  }
  bool operator==(const Reliability&) const = default;

private:
  ReliabilityKind::Type kind_;
  Duration max_blocking_time_;
};

/// Number of samples per instance that are kept until they are sent or taken. The depth is positive.
class History {
public:
  History(HistoryKind::Type kind = HistoryKind::KEEP_LAST, std::int32_t depth = 1)
      : kind_(kind), depth_(depth) {}
  static History KeepAll() { return {HistoryKind::KEEP_ALL}; }
  static History KeepLast(std::uint32_t depth) {
    return {HistoryKind::KEEP_LAST, static_cast<std::int32_t>(depth)};
  }
  HistoryKind::Type kind() const { return kind_; }
  History& kind(HistoryKind::Type kind) {
    kind_ = kind;
    return *this;
  }
  std::int32_t depth() const { return depth_; }
  History& depth(std::int32_t depth) {
    depth_ = depth;
    return *this;
  }
  bool operator==(const History&) const = default;

private:
  HistoryKind::Type kind_;
  std::int32_t depth_;
};

/// Limits on the samples that an entity stores; each positive or LENGTH_UNLIMITED.
class ResourceLimits {
public:
  ResourceLimits(std::int32_t max_samples = LENGTH_UNLIMITED, std::int32_t max_instances = LENGTH_UNLIMITED,
                 std::int32_t max_samples_per_instance = LENGTH_UNLIMITED)
      : max_samples_(max_samples),
        max_instances_(max_instances),
        max_samples_per_instance_(max_samples_per_instance) {}
  std::int32_t max_samples() const { return max_samples_; }
  ResourceLimits& max_samples(std::int32_t value) {
    max_samples_ = value;
    return *this;
  }
  std::int32_t max_instances() const { return max_instances_; }
  ResourceLimits& max_instances(std::int32_t value) {
    max_instances_ = value;
    return *this;
  }
  std::int32_t max_samples_per_instance() const { return max_samples_per_instance_; }
  ResourceLimits& max_samples_per_instance(std::int32_t value) {
    max_samples_per_instance_ = value;
    return *this;
  }
  bool operator==(const ResourceLimits&) const = default;

private:
  std::int32_t max_samples_;
  std::int32_t max_instances_;
  std::int32_t max_samples_per_instance_;
};

/// Effect of unregistering an instance.
class WriterDataLifecycle {
public:
  explicit WriterDataLifecycle(bool autodispose_unregistered_instances = true)
      : autodispose_(autodispose_unregistered_instances) {}
  static WriterDataLifecycle AutoDisposeUnregisteredInstances() { return WriterDataLifecycle(true); }
  static WriterDataLifecycle ManuallyDisposeUnregisteredInstances() { return WriterDataLifecycle(false); }
  bool autodispose_unregistered_instances() const { return autodispose_; }
  WriterDataLifecycle& autodispose_unregistered_instances(bool value) {
    autodispose_ = value;
    return *this;
  }
  bool operator==(const WriterDataLifecycle&) const = default;

private:
  bool autodispose_;
};

/// A hint to the transport.
class TransportPriority {
public:
  explicit TransportPriority(std::int32_t priority = 0) : value_(priority) {}
  std::int32_t value() const { return value_; }
  TransportPriority& value(std::int32_t priority) {
    value_ = priority;
    return *this;
  }
  bool operator==(const TransportPriority&) const = default;

private:
  std::int32_t value_;
};

/// Number of samples per instance that a transient-local writer keeps for late readers; of a topic. Left out:
/// everything but this depth.
class DurabilityService {
public:
  DurabilityService() = default;
  std::int32_t history_depth() const { return history_depth_; }
  DurabilityService& history_depth(std::int32_t depth) {
    history_depth_ = depth;
    return *this;
  }
  bool operator==(const DurabilityService&) const = default;

private:
  std::int32_t history_depth_ = 1;
};

/// The number of a policy, as in IncompatibleQosStatus::last_policy_id.
template <class Policy>
struct policy_id;
template <>
struct policy_id<UserData> {
  static constexpr QosPolicyId value = DDS_USERDATA_QOS_POLICY_ID;
};
template <>
struct policy_id<Durability> {
  static constexpr QosPolicyId value = DDS_DURABILITY_QOS_POLICY_ID;
};
template <>
struct policy_id<Deadline> {
  static constexpr QosPolicyId value = DDS_DEADLINE_QOS_POLICY_ID;
};
template <>
struct policy_id<LatencyBudget> {
  static constexpr QosPolicyId value = DDS_LATENCYBUDGET_QOS_POLICY_ID;
};
template <>
struct policy_id<Ownership> {
  static constexpr QosPolicyId value = DDS_OWNERSHIP_QOS_POLICY_ID;
};
template <>
struct policy_id<Liveliness> {
  static constexpr QosPolicyId value = DDS_LIVELINESS_QOS_POLICY_ID;
};
template <>
struct policy_id<Partition> {
  static constexpr QosPolicyId value = DDS_PARTITION_QOS_POLICY_ID;
};
template <>
struct policy_id<Reliability> {
  static constexpr QosPolicyId value = DDS_RELIABILITY_QOS_POLICY_ID;
};
template <>
struct policy_id<History> {
  static constexpr QosPolicyId value = DDS_HISTORY_QOS_POLICY_ID;
};

}  // namespace dds::inline sonopose_psm::core::policy
