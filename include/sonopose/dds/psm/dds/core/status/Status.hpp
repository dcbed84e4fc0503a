#pragma once
/// \file
/// Communication statuses. Left out: InconsistentTopicStatus, SampleRejectedState, and the counts per policy.

#include "../types.hpp"

#include <dds/dds.h>

#include <bitset>
#include <cstdint>

namespace dds::inline sonopose_psm::core {

class InstanceHandle;

namespace policy {
using QosPolicyId = std::uint32_t;
}

namespace status {

/// A set of statuses, with the bits of the DDS specification.
class StatusMask : public std::bitset<32> {
public:
  using MaskType = std::bitset<32>;

  StatusMask() = default;
  explicit StatusMask(std::uint32_t mask) : bitset(mask) {}

  StatusMask& operator<<(const StatusMask& other) {
    *this |= other;
    return *this;
  }
  StatusMask operator|(const StatusMask& other) const { return StatusMask(*this) << other; }

  static StatusMask all() { return StatusMask(0x80007fe7U); }
  static StatusMask none() { return StatusMask(0U); }
  static StatusMask inconsistent_topic() { return StatusMask(1U << 0U); }
  static StatusMask offered_deadline_missed() { return StatusMask(1U << 1U); }
  static StatusMask requested_deadline_missed() { return StatusMask(1U << 2U); }
  static StatusMask offered_incompatible_qos() { return StatusMask(1U << 5U); }
  static StatusMask requested_incompatible_qos() { return StatusMask(1U << 6U); }
  static StatusMask sample_lost() { return StatusMask(1U << 7U); }
  static StatusMask sample_rejected() { return StatusMask(1U << 8U); }
  static StatusMask data_on_readers() { return StatusMask(1U << 9U); }
  static StatusMask data_available() { return StatusMask(1U << 10U); }
  static StatusMask liveliness_lost() { return StatusMask(1U << 11U); }
  static StatusMask liveliness_changed() { return StatusMask(1U << 12U); }
  static StatusMask publication_matched() { return StatusMask(1U << 13U); }
  static StatusMask subscription_matched() { return StatusMask(1U << 14U); }
};

/// Counts common to all statuses. `…_change` is since the last call.
template <class C>
class CountedStatus {
public:
  CountedStatus() = default;
  explicit CountedStatus(const C& status) : c_(status) {}
  std::int32_t total_count() const { return static_cast<std::int32_t>(c_.total_count); }
  std::int32_t total_count_change() const { return c_.total_count_change; }

protected:
  C c_{};
};

using SampleLostStatus = CountedStatus<dds_sample_lost_status_t>;
using LivelinessLostStatus = CountedStatus<dds_liveliness_lost_status_t>;

class SampleRejectedStatus : public CountedStatus<dds_sample_rejected_status_t> {
public:
  using CountedStatus::CountedStatus;
  const InstanceHandle last_instance_handle() const;
};

class LivelinessChangedStatus {
public:
  LivelinessChangedStatus() = default;
  explicit LivelinessChangedStatus(const dds_liveliness_changed_status_t& status) : c_(status) {}
  std::int32_t alive_count() const { return static_cast<std::int32_t>(c_.alive_count); }
  std::int32_t not_alive_count() const { return static_cast<std::int32_t>(c_.not_alive_count); }
  std::int32_t alive_count_change() const { return c_.alive_count_change; }
  std::int32_t not_alive_count_change() const { return c_.not_alive_count_change; }
  const InstanceHandle last_publication_handle() const;

private:
  dds_liveliness_changed_status_t c_{};
};

template <class C>
class DeadlineMissedStatus : public CountedStatus<C> {
public:
  using CountedStatus<C>::CountedStatus;
  const InstanceHandle last_instance_handle() const;
};
using OfferedDeadlineMissedStatus = DeadlineMissedStatus<dds_offered_deadline_missed_status_t>;
using RequestedDeadlineMissedStatus = DeadlineMissedStatus<dds_requested_deadline_missed_status_t>;

template <class C>
class IncompatibleQosStatus : public CountedStatus<C> {
public:
  using CountedStatus<C>::CountedStatus;
  policy::QosPolicyId last_policy_id() const { return this->c_.last_policy_id; }
};
using OfferedIncompatibleQosStatus = IncompatibleQosStatus<dds_offered_incompatible_qos_status_t>;
using RequestedIncompatibleQosStatus = IncompatibleQosStatus<dds_requested_incompatible_qos_status_t>;

template <class C>
class MatchedStatus : public CountedStatus<C> {
public:
  using CountedStatus<C>::CountedStatus;
  std::int32_t current_count() const { return static_cast<std::int32_t>(this->c_.current_count); }
  std::int32_t current_count_change() const { return this->c_.current_count_change; }
};

class PublicationMatchedStatus : public MatchedStatus<dds_publication_matched_status_t> {
public:
  using MatchedStatus::MatchedStatus;
  const InstanceHandle last_subscription_handle() const;
};

class SubscriptionMatchedStatus : public MatchedStatus<dds_subscription_matched_status_t> {
public:
  using MatchedStatus::MatchedStatus;
  const InstanceHandle last_publication_handle() const;
};

}  // namespace status
}  // namespace dds::inline sonopose_psm::core
