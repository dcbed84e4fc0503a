#pragma once
/// \file
/// The small value types of the DDS layer: durations, instance handles, sample states, status masks.

#include <dds/dds.h>

#include <chrono>
#include <compare>
#include <cstdint>

namespace sonopose::dds {

/// Nanoseconds, as in DDS.
using Duration = std::chrono::nanoseconds;

/// Infinite duration of DDS.
inline constexpr Duration infinite = Duration::max();
static_assert(infinite.count() == DDS_INFINITY);

/// Identifies an instance, a reader or a writer within this process. Nil identifies nothing.
struct InstanceHandle {
  dds_instance_handle_t value = DDS_HANDLE_NIL;

  bool is_nil() const noexcept { return value == DDS_HANDLE_NIL; }
  auto operator<=>(const InstanceHandle&) const = default;  // NOLINT(modernize-use-nullptr): a false alarm
};

/// Selects samples for a read, a take or a `ReadCondition`: a mask of `DDS_…_STATE` bits, at least one bit of
/// each of the three kinds (sample, view, instance).
struct DataState {
  std::uint32_t mask = DDS_ANY_STATE;

  /// All samples, including notifications that an instance was disposed of or lost its writers.
  static constexpr DataState any() { return {DDS_ANY_STATE}; }
  /// Samples that were not read before.
  static constexpr DataState not_read() {
    return {DDS_NOT_READ_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ANY_INSTANCE_STATE};
  }
  /// Unread samples of instances that are alive.
  static constexpr DataState new_data() {
    return {DDS_NOT_READ_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE};
  }
};

/// A set of communication statuses (`DDS_…_STATUS` bits).
struct StatusMask {
  std::uint32_t mask = 0;

  static constexpr StatusMask none() { return {0}; }
  static constexpr StatusMask all() { return {(1U << (DDS_STATUS_ID_MAX + 1)) - 1U}; }
  static constexpr StatusMask data_available() { return {DDS_DATA_AVAILABLE_STATUS}; }
  static constexpr StatusMask publication_matched() { return {DDS_PUBLICATION_MATCHED_STATUS}; }
  static constexpr StatusMask subscription_matched() { return {DDS_SUBSCRIPTION_MATCHED_STATUS}; }
  static constexpr StatusMask offered_deadline_missed() { return {DDS_OFFERED_DEADLINE_MISSED_STATUS}; }
  static constexpr StatusMask requested_deadline_missed() { return {DDS_REQUESTED_DEADLINE_MISSED_STATUS}; }
  static constexpr StatusMask offered_incompatible_qos() { return {DDS_OFFERED_INCOMPATIBLE_QOS_STATUS}; }
  static constexpr StatusMask requested_incompatible_qos() { return {DDS_REQUESTED_INCOMPATIBLE_QOS_STATUS}; }
  static constexpr StatusMask liveliness_changed() { return {DDS_LIVELINESS_CHANGED_STATUS}; }
  static constexpr StatusMask liveliness_lost() { return {DDS_LIVELINESS_LOST_STATUS}; }
  static constexpr StatusMask sample_lost() { return {DDS_SAMPLE_LOST_STATUS}; }
  static constexpr StatusMask sample_rejected() { return {DDS_SAMPLE_REJECTED_STATUS}; }

  constexpr StatusMask without(StatusMask other) const { return {mask & ~other.mask}; }
  constexpr bool test(StatusMask other) const { return (mask & other.mask) != 0; }
  friend constexpr StatusMask operator|(StatusMask a, StatusMask b) { return {a.mask | b.mask}; }
};

// The statuses are Cyclone's own structs. Reading one clears its `…_change` fields.
using PublicationMatchedStatus = dds_publication_matched_status_t;
using SubscriptionMatchedStatus = dds_subscription_matched_status_t;
using OfferedDeadlineMissedStatus = dds_offered_deadline_missed_status_t;
using RequestedDeadlineMissedStatus = dds_requested_deadline_missed_status_t;
using OfferedIncompatibleQosStatus = dds_offered_incompatible_qos_status_t;
using RequestedIncompatibleQosStatus = dds_requested_incompatible_qos_status_t;
using LivelinessLostStatus = dds_liveliness_lost_status_t;
using LivelinessChangedStatus = dds_liveliness_changed_status_t;
using SampleLostStatus = dds_sample_lost_status_t;
using SampleRejectedStatus = dds_sample_rejected_status_t;

}  // namespace sonopose::dds
