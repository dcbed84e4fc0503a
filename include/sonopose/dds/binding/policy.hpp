#pragma once
/// \file
/// QoS policies as plain values. `apply` writes one into a C QoS object and throws std::invalid_argument for
/// an invalid value. `from` reads it back; empty if it is not set.

#include <sonopose/dds/binding/types.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::dds::policy {

enum class ReliabilityKind : std::uint8_t { best_effort, reliable };
enum class HistoryKind : std::uint8_t { keep_last, keep_all };
enum class DurabilityKind : std::uint8_t { volatile_data, transient_local };
enum class LivelinessKind : std::uint8_t { automatic, manual_by_participant, manual_by_topic };
enum class OwnershipKind : std::uint8_t { shared, exclusive };

/// "No limit" in `ResourceLimits`.
inline constexpr std::int32_t length_unlimited = DDS_LENGTH_UNLIMITED;

/// Maximum time between two samples of an instance. Positive: Cyclone DDS 0.10 crashes at zero.
struct Deadline {
  Duration period = infinite;
  void apply(dds_qos_t* qos) const;
  static std::optional<Deadline> from(const dds_qos_t* qos);
};

/// Maximum delay of a sample to send it together with others.
struct LatencyBudget {
  Duration duration{0};
  void apply(dds_qos_t* qos) const;
  static std::optional<LatencyBudget> from(const dds_qos_t* qos);
};

/// Time for which a sample is useful after its source time stamp. Positive.
struct Lifespan {
  Duration duration = infinite;
  void apply(dds_qos_t* qos) const;
  static std::optional<Lifespan> from(const dds_qos_t* qos);
};

/// Repetition of lost samples, and the longest time that a write may block.
struct Reliability {
  ReliabilityKind kind = ReliabilityKind::best_effort;
  Duration max_blocking_time = std::chrono::milliseconds(100);
  void apply(dds_qos_t* qos) const;
  static std::optional<Reliability> from(const dds_qos_t* qos);
  static Reliability best_effort() { return {}; }
  static Reliability reliable(Duration max_blocking_time = std::chrono::milliseconds(100)) {
    return {ReliabilityKind::reliable, max_blocking_time};
  }
};

/// Number of samples per instance that are kept until they are sent or taken. The depth is positive.
struct History {
  HistoryKind kind = HistoryKind::keep_last;
  std::int32_t depth = 1;
  void apply(dds_qos_t* qos) const;
  static std::optional<History> from(const dds_qos_t* qos);
  static History keep_last(std::int32_t depth) { return {HistoryKind::keep_last, depth}; }
  static History keep_all() { return {HistoryKind::keep_all, 1}; }
};

/// Delivery of samples to readers that appeared after they were written.
struct Durability {
  DurabilityKind kind = DurabilityKind::volatile_data;
  void apply(dds_qos_t* qos) const;
  static std::optional<Durability> from(const dds_qos_t* qos);
};

/// Assertion of a writer's liveliness, and the lease after which it counts as dead. The lease is positive.
struct Liveliness {
  LivelinessKind kind = LivelinessKind::automatic;
  Duration lease_duration = infinite;
  void apply(dds_qos_t* qos) const;
  static std::optional<Liveliness> from(const dds_qos_t* qos);
};

/// Exclusive or shared ownership of an instance. The two never match.
struct Ownership {
  OwnershipKind kind = OwnershipKind::shared;
  void apply(dds_qos_t* qos) const;
  static std::optional<Ownership> from(const dds_qos_t* qos);
};

/// Number of samples per instance that a transient-local writer keeps for late readers; the DDS default is 1.
struct DurabilityService {
  std::int32_t history_depth = 1;
  void apply(dds_qos_t* qos) const;
  static std::optional<DurabilityService> from(const dds_qos_t* qos);
};

/// The writer with the highest strength owns the instance. Changeable on an existing writer.
struct OwnershipStrength {
  std::int32_t value = 0;
  void apply(dds_qos_t* qos) const;
  static std::optional<OwnershipStrength> from(const dds_qos_t* qos);
};

/// Limits on the samples that an entity stores; each positive or `length_unlimited`.
struct ResourceLimits {
  std::int32_t max_samples = length_unlimited;
  std::int32_t max_instances = length_unlimited;
  std::int32_t max_samples_per_instance = length_unlimited;
  void apply(dds_qos_t* qos) const;
  static std::optional<ResourceLimits> from(const dds_qos_t* qos);
};

/// A hint to the transport.
struct TransportPriority {
  std::int32_t value = 0;
  void apply(dds_qos_t* qos) const;
  static std::optional<TransportPriority> from(const dds_qos_t* qos);
};

/// Effect of unregistering an instance.
struct WriterDataLifecycle {
  bool autodispose_unregistered_instances = true;  ///< unregistering an instance also disposes it
  void apply(dds_qos_t* qos) const;
  static std::optional<WriterDataLifecycle> from(const dds_qos_t* qos);
};

/// Reader and writer match only if they share a partition. No name means the partition "".
struct Partition {
  std::vector<std::string> names;
  void apply(dds_qos_t* qos) const;
  static std::optional<Partition> from(const dds_qos_t* qos);
};

/// Bytes that discovery sends to all matched endpoints.
struct UserData {
  std::vector<std::uint8_t> value;
  void apply(dds_qos_t* qos) const;
  static std::optional<UserData> from(const dds_qos_t* qos);
};

}  // namespace sonopose::dds::policy
