#pragma once
/// \file
/// Reads samples of one type from a topic.

#include <sonopose/dds/binding/entity.hpp>
#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/listener.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/sample.hpp>
#include <sonopose/dds/binding/topic.hpp>

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::dds {

/// Identity of a matched writer.
struct PublicationData {
  std::string topic_name;
  std::string type_name;
  dds_guid_t key{};              ///< GUID of the writer
  dds_guid_t participant_key{};  ///< GUID of its participant
  std::vector<std::uint8_t> user_data;
};

/// Most samples of one loan. Cyclone DDS 0.10 keeps the memory of a reader's largest loan. For a later,
/// smaller one it still writes a pointer for each of those samples into the caller's array. All arrays for
/// loans therefore have this length.
constexpr std::size_t max_loan = 256;

namespace detail {
std::vector<InstanceHandle> matched_publications(dds_entity_t reader);
PublicationData matched_publication_data(dds_entity_t reader, InstanceHandle publication);

/// Calls `dds_take_mask` or `dds_read_mask` on a reader whose loans never exceed `largest`. Throws `Error`.
template <class T, class Call>
LoanedSamples<T> loan(dds_entity_t reader, const char* name, Call call, std::size_t max_samples,
                      std::size_t largest, DataState state) {
  std::vector<void*> data(largest, nullptr);
  std::vector<dds_sample_info_t> infos(std::min(max_samples, largest));
  const ReturnCode count = check(name, call(reader, data.data(), infos.data(), infos.size(),
                                            static_cast<std::uint32_t>(infos.size()), state.mask));
  data.resize(static_cast<std::size_t>(count));
  infos.resize(static_cast<std::size_t>(count));
  return LoanedSamples<T>(reader, std::move(data), std::move(infos));
}
}  // namespace detail

/// Reads samples of one type. Every member but the `try_…` ones throws `Error`.
template <class T>
class DataReader : public Entity {
public:
  DataReader() noexcept = default;

  /// `listener` must outlive the reader and receives the statuses in `mask`.
  DataReader(const DomainParticipant& participant, const Topic<T>& topic, const Qos& qos = {},
             DataReaderListener<T>* listener = nullptr, StatusMask mask = StatusMask::all())
      : Entity(check("dds_create_reader", topic.name(),
                     dds_create_reader(participant.handle(), topic.handle(), qos.get(),
                                       detail::c_listener(listener, mask).get()))) {}

  /// A non-owning view of a reader.
  static DataReader borrow(dds_entity_t handle) noexcept { return DataReader(handle, Ownership::borrowed); }

  /// Takes up to `max_samples` (at most `max_loan`) out of the reader, on loan.
  LoanedSamples<T> take(std::size_t max_samples = max_loan, DataState state = DataState::any()) {
    return detail::loan<T>(handle(), "dds_take_mask", dds_take_mask, max_samples, max_loan, state);
  }

  /// Reads up to `max_samples` (at most `max_loan`) on loan. They stay in the reader, marked as read.
  LoanedSamples<T> read(std::size_t max_samples = max_loan, DataState state = DataState::any()) {
    return detail::loan<T>(handle(), "dds_read_mask", dds_read_mask, max_samples, max_loan, state);
  }

  /// Takes all available samples on the hot path, oldest first within an instance. Calls `on_data(const T&,
  /// const SampleInfo&)` for each sample with data. Allocates nothing after the first call. Returns the
  /// number of samples, or a negative return code.
  template <class OnData>
  ReturnCode try_take_each(OnData&& on_data) {
    return try_take_each(on_data, [](const T&, const SampleInfo&) {});
  }

  /// Overload that calls `on_state(const T& key, const SampleInfo&)` for instances that were disposed of or
  /// lost their writers. Only the key fields of `key` are set.
  template <class OnData, class OnState>
  ReturnCode try_take_each(OnData&& on_data, OnState&& on_state) {
    constexpr std::int32_t batch = 8;  // small: Cyclone DDS clears every sample of a returned loan
    // Samples without pointers are taken into this memory, which saves returning a loan.
    const bool is_flat = (TopicTraits<T>::descriptor().m_flagset & DDS_TOPIC_FIXED_SIZE) != 0;
    std::array<T, batch> memory{};
    ReturnCode total = 0;
    ReturnCode taken = batch;
    while (taken == batch) {
      std::array<void*, max_loan> samples;  // NOLINT(*-member-init): dds_take reads only the first
      samples[0] = nullptr;
      for (std::size_t i = 0; is_flat && i < memory.size(); ++i) samples[i] = &memory[i];
      std::array<dds_sample_info_t, batch> infos;  // NOLINT(*-member-init): dds_take fills in what is used
      taken = dds_take(handle(), samples.data(), infos.data(), batch, batch);
      if (taken <= 0) return taken < 0 ? taken : total;
      std::optional<Loan> loan;
      if (!is_flat) loan.emplace(handle(), samples.data(), taken);
      for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i) {
        const T& data = *static_cast<const T*>(samples[i]);
        const SampleInfo info(infos[i]);
        if (info.valid()) {
          on_data(data, info);
        } else {
          on_state(data, info);
        }
      }
      total += taken;
    }
    return total;
  }

  /// Like `try_take_each`, but throws on errors.
  template <class... Visitors>
  std::size_t take_each(Visitors&&... visitors) {
    return static_cast<std::size_t>(check("dds_take", try_take_each(visitors...)));
  }

  /// Sets the key fields of `key` to those of an instance. Does not throw; returns a negative code if the
  /// instance is unknown.
  ReturnCode try_key_value(T& key, InstanceHandle instance) const noexcept {
    return dds_instance_get_key(handle(), instance.value, &key);
  }

  std::vector<InstanceHandle> matched_publications() const { return detail::matched_publications(handle()); }

  PublicationData matched_publication_data(InstanceHandle publication) const {
    return detail::matched_publication_data(handle(), publication);
  }

  /// Waits until the transient-local samples from before this reader have arrived. Returns false after
  /// `timeout`.
  bool wait_for_historical_data(Duration timeout) {
    const ReturnCode code = dds_reader_wait_for_historical_data(handle(), timeout.count());
    if (code == DDS_RETCODE_TIMEOUT) return false;
    check("dds_reader_wait_for_historical_data", code);
    return true;
  }

  SubscriptionMatchedStatus subscription_matched_status() {
    return status<SubscriptionMatchedStatus>("dds_get_subscription_matched_status",
                                             dds_get_subscription_matched_status);
  }
  RequestedDeadlineMissedStatus requested_deadline_missed_status() {
    return status<RequestedDeadlineMissedStatus>("dds_get_requested_deadline_missed_status",
                                                 dds_get_requested_deadline_missed_status);
  }
  RequestedIncompatibleQosStatus requested_incompatible_qos_status() {
    return status<RequestedIncompatibleQosStatus>("dds_get_requested_incompatible_qos_status",
                                                  dds_get_requested_incompatible_qos_status);
  }
  LivelinessChangedStatus liveliness_changed_status() {
    return status<LivelinessChangedStatus>("dds_get_liveliness_changed_status",
                                           dds_get_liveliness_changed_status);
  }
  SampleLostStatus sample_lost_status() {
    return status<SampleLostStatus>("dds_get_sample_lost_status", dds_get_sample_lost_status);
  }
  SampleRejectedStatus sample_rejected_status() {
    return status<SampleRejectedStatus>("dds_get_sample_rejected_status", dds_get_sample_rejected_status);
  }

private:
  using Entity::Entity;

  /// Returns the loan even if the visitor throws.
  class Loan {
  public:
    Loan(dds_entity_t reader, void** samples, ReturnCode count)
        : reader_(reader), samples_(samples), count_(count) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    Loan(Loan&&) = delete;
    Loan& operator=(Loan&&) = delete;
    ~Loan() { dds_return_loan(reader_, samples_, count_); }

  private:
    dds_entity_t reader_;
    void** samples_;
    ReturnCode count_;
  };

  template <class Status, class Call>
  Status status(const char* name, Call call) {
    Status status{};
    check(name, call(handle(), &status));
    return status;
  }
};

}  // namespace sonopose::dds
