#pragma once
/// \file
/// Writes samples of one type to a topic.

#include <sonopose/dds/binding/entity.hpp>
#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/listener.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/topic.hpp>

#include <dds/dds.h>

#include <cstdint>
#include <vector>

namespace sonopose::dds {

/// Identity of a matched reader.
struct SubscriptionData {
  dds_guid_t participant_key{};  ///< GUID of its participant
  std::vector<std::uint8_t> user_data;
};

namespace detail {
std::vector<InstanceHandle> matched_subscriptions(dds_entity_t writer);
SubscriptionData matched_subscription_data(dds_entity_t writer, InstanceHandle subscription);
}  // namespace detail

/// Writes samples of one type. Every member but the `try_…` ones throws `Error`.
template <class T>
class DataWriter : public Entity {
public:
  DataWriter() noexcept = default;

  /// `listener` must outlive the writer and receives the statuses in `mask`.
  DataWriter(const DomainParticipant& participant, const Topic<T>& topic, const Qos& qos = {},
             DataWriterListener<T>* listener = nullptr, StatusMask mask = StatusMask::all())
      : Entity(check("dds_create_writer", topic.name(),
                     dds_create_writer(participant.handle(), topic.handle(), qos.get(),
                                       detail::c_listener(listener, mask).get()))) {}

  /// A non-owning view of a writer.
  static DataWriter borrow(dds_entity_t handle) noexcept { return DataWriter(handle, Ownership::borrowed); }

  void write(const T& sample) { check("dds_write", try_write(sample)); }

  /// Writes with the given source time stamp, ns since the Unix epoch.
  void write(const T& sample, std::int64_t source_timestamp_ns) {
    check("dds_write_ts", dds_write_ts(handle(), &sample, source_timestamp_ns));
  }

  /// Writes without exceptions, for the hot path. If `is_timeout`, readers blocked for max_blocking_time and
  /// the sample was not written.
  ReturnCode try_write(const T& sample) noexcept { return dds_write(handle(), &sample); }

  /// Sends pending samples if the domain batches writes (DomainOptions::batch_writes).
  void flush() noexcept { dds_write_flush(handle()); }

  /// Disposes of the instance. Only the key fields of `key` are used.
  void dispose_instance(const T& key) { check("dds_dispose", dds_dispose(handle(), &key)); }

  /// Unregisters the instance: its deadline ends, and a weaker exclusive writer takes over immediately. Call
  /// it on a clean exit. Only the key fields of `key` are used.
  void unregister_instance(const T& key) {
    check("dds_unregister_instance", dds_unregister_instance(handle(), &key));
  }

  /// Unregisters the instance without exceptions, for destructors.
  ReturnCode try_unregister_instance(const T& key) noexcept {
    return dds_unregister_instance(handle(), &key);
  }

  /// Handle of an instance that this writer has written; otherwise nil.
  InstanceHandle lookup_instance(const T& key) const { return {dds_lookup_instance(handle(), &key)}; }

  /// Asserts manual liveliness. After its lease has expired, only a write revives the writer (Cyclone DDS
  /// 0.10).
  void assert_liveliness() { check("dds_assert_liveliness", dds_assert_liveliness(handle())); }

  /// Asserts manual liveliness without exceptions, for threads that must continue.
  ReturnCode try_assert_liveliness() noexcept { return dds_assert_liveliness(handle()); }

  /// True if all readers acknowledged all samples within `timeout`.
  bool wait_for_acknowledgments(Duration timeout) {
    const ReturnCode code = dds_wait_for_acks(handle(), timeout.count());
    if (code == DDS_RETCODE_TIMEOUT) return false;
    check("dds_wait_for_acks", code);
    return true;
  }

  /// Changes the strength with which the writer claims its instances.
  void ownership_strength(std::int32_t strength) { qos(Qos() << policy::OwnershipStrength{strength}); }
  using Entity::qos;

  std::vector<InstanceHandle> matched_subscriptions() const {
    return detail::matched_subscriptions(handle());
  }

  SubscriptionData matched_subscription_data(InstanceHandle subscription) const {
    return detail::matched_subscription_data(handle(), subscription);
  }

  PublicationMatchedStatus publication_matched_status() {
    PublicationMatchedStatus status{};
    check("dds_get_publication_matched_status", dds_get_publication_matched_status(handle(), &status));
    return status;
  }

  /// Status of missed deadlines. Cyclone DDS 0.10 leaves its `last_instance_handle` nil.
  OfferedDeadlineMissedStatus offered_deadline_missed_status() {
    OfferedDeadlineMissedStatus status{};
    check("dds_get_offered_deadline_missed_status",
          dds_get_offered_deadline_missed_status(handle(), &status));
    return status;
  }

  OfferedIncompatibleQosStatus offered_incompatible_qos_status() {
    OfferedIncompatibleQosStatus status{};
    check("dds_get_offered_incompatible_qos_status",
          dds_get_offered_incompatible_qos_status(handle(), &status));
    return status;
  }

  LivelinessLostStatus liveliness_lost_status() {
    LivelinessLostStatus status{};
    check("dds_get_liveliness_lost_status", dds_get_liveliness_lost_status(handle(), &status));
    return status;
  }

private:
  using Entity::Entity;
};

}  // namespace sonopose::dds
