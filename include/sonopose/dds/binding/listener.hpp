#pragma once
/// \file
/// Callbacks of readers and writers, passed when the entity is created so that no event is missed.
///
/// The contract:
/// - Callbacks run on threads of Cyclone DDS: data of other processes on its one receive thread, data of this
///   process on the writing thread, deadlines and liveliness on others. They must take microseconds, do no
///   I/O, not block, and neither create nor destroy entities.
/// - A callback may run before the constructor of the entity has returned. Samples can be taken then, but the
///   entity's own instance handle is still nil.
/// - Callbacks are noexcept: an exception cannot pass through Cyclone DDS and terminates the process.
/// - The listener must outlive its entity. Destroying the entity waits for a running callback.
/// - The entity that a callback receives is a non-owning view.
/// - A status that a listener handles does not wake a `WaitSet`.

#include <sonopose/dds/binding/types.hpp>

#include <dds/dds.h>

#include <memory>

namespace sonopose::dds {

template <class T>
class DataReader;
template <class T>
class DataWriter;

/// Callbacks of a reader. Override those of interest; the defaults do nothing.
template <class T>
class DataReaderListener {
public:
  DataReaderListener() = default;
  DataReaderListener(const DataReaderListener&) = delete;
  DataReaderListener& operator=(const DataReaderListener&) = delete;
  DataReaderListener(DataReaderListener&&) = delete;
  DataReaderListener& operator=(DataReaderListener&&) = delete;
  virtual ~DataReaderListener() = default;

  virtual void on_data_available(DataReader<T>&) noexcept {}
  virtual void on_subscription_matched(DataReader<T>&, const SubscriptionMatchedStatus&) noexcept {}
  virtual void on_requested_deadline_missed(DataReader<T>&, const RequestedDeadlineMissedStatus&) noexcept {}
  virtual void on_requested_incompatible_qos(DataReader<T>&, const RequestedIncompatibleQosStatus&) noexcept {
  }
  virtual void on_liveliness_changed(DataReader<T>&, const LivelinessChangedStatus&) noexcept {}
  virtual void on_sample_lost(DataReader<T>&, const SampleLostStatus&) noexcept {}
  virtual void on_sample_rejected(DataReader<T>&, const SampleRejectedStatus&) noexcept {}
};

/// Callbacks of a writer. Override those of interest; the defaults do nothing.
template <class T>
class DataWriterListener {
public:
  DataWriterListener() = default;
  DataWriterListener(const DataWriterListener&) = delete;
  DataWriterListener& operator=(const DataWriterListener&) = delete;
  DataWriterListener(DataWriterListener&&) = delete;
  DataWriterListener& operator=(DataWriterListener&&) = delete;
  virtual ~DataWriterListener() = default;

  virtual void on_publication_matched(DataWriter<T>&, const PublicationMatchedStatus&) noexcept {}
  virtual void on_offered_deadline_missed(DataWriter<T>&, const OfferedDeadlineMissedStatus&) noexcept {}
  virtual void on_offered_incompatible_qos(DataWriter<T>&, const OfferedIncompatibleQosStatus&) noexcept {}
  virtual void on_liveliness_lost(DataWriter<T>&, const LivelinessLostStatus&) noexcept {}
};

namespace detail {

struct DeleteListener {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using CListener = std::unique_ptr<dds_listener_t, DeleteListener>;

/// C callback for one status: finds the C++ listener in `arg` and calls its `Method` with a borrowed entity.
template <class Endpoint, class Listener, auto Method, class Status>
void forward_status(dds_entity_t handle, Status status, void* arg) noexcept {
  Endpoint borrowed = Endpoint::borrow(handle);
  (static_cast<Listener*>(arg)->*Method)(borrowed, status);
}

template <class T>
CListener c_listener(DataReaderListener<T>* listener, StatusMask mask) {
  if (listener == nullptr) return nullptr;
  using L = DataReaderListener<T>;
  using R = DataReader<T>;
  CListener c(dds_create_listener(listener));
  if (mask.test(StatusMask::data_available())) {
    dds_lset_data_available(c.get(), [](dds_entity_t handle, void* arg) noexcept {
      R borrowed = R::borrow(handle);
      static_cast<L*>(arg)->on_data_available(borrowed);
    });
  }
  if (mask.test(StatusMask::subscription_matched())) {
    dds_lset_subscription_matched(
        c.get(), forward_status<R, L, &L::on_subscription_matched, SubscriptionMatchedStatus>);
  }
  if (mask.test(StatusMask::requested_deadline_missed())) {
    dds_lset_requested_deadline_missed(
        c.get(), forward_status<R, L, &L::on_requested_deadline_missed, RequestedDeadlineMissedStatus>);
  }
  if (mask.test(StatusMask::requested_incompatible_qos())) {
    dds_lset_requested_incompatible_qos(
        c.get(), forward_status<R, L, &L::on_requested_incompatible_qos, RequestedIncompatibleQosStatus>);
  }
  if (mask.test(StatusMask::liveliness_changed())) {
    dds_lset_liveliness_changed(c.get(),
                                forward_status<R, L, &L::on_liveliness_changed, LivelinessChangedStatus>);
  }
  if (mask.test(StatusMask::sample_lost())) {
    dds_lset_sample_lost(c.get(), forward_status<R, L, &L::on_sample_lost, SampleLostStatus>);
  }
  if (mask.test(StatusMask::sample_rejected())) {
    dds_lset_sample_rejected(c.get(), forward_status<R, L, &L::on_sample_rejected, SampleRejectedStatus>);
  }
  return c;
}

template <class T>
CListener c_listener(DataWriterListener<T>* listener, StatusMask mask) {
  if (listener == nullptr) return nullptr;
  using L = DataWriterListener<T>;
  using W = DataWriter<T>;
  CListener c(dds_create_listener(listener));
  if (mask.test(StatusMask::publication_matched())) {
    dds_lset_publication_matched(c.get(),
                                 forward_status<W, L, &L::on_publication_matched, PublicationMatchedStatus>);
  }
  if (mask.test(StatusMask::offered_deadline_missed())) {
    dds_lset_offered_deadline_missed(
        c.get(), forward_status<W, L, &L::on_offered_deadline_missed, OfferedDeadlineMissedStatus>);
  }
  if (mask.test(StatusMask::offered_incompatible_qos())) {
    dds_lset_offered_incompatible_qos(
        c.get(), forward_status<W, L, &L::on_offered_incompatible_qos, OfferedIncompatibleQosStatus>);
  }
  if (mask.test(StatusMask::liveliness_lost())) {
    dds_lset_liveliness_lost(c.get(), forward_status<W, L, &L::on_liveliness_lost, LivelinessLostStatus>);
  }
  return c;
}

}  // namespace detail
}  // namespace sonopose::dds
