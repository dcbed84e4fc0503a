#pragma once
/// \file
/// Subscribers and readers. Left out: listeners of subscribers and of AnyDataReader, notify_datareaders,
/// content filters and queries, next_instance, coherent access, copying into iterators, `>>` and `<<` of
/// readers, to set default_datareader_qos, TopicInstance, discovery.

#include "../core/cond/WaitSet.hpp"
#include "../core/detail/Callbacks.hpp"
#include "../core/detail/EntityQos.hpp"
#include "../topic/ddstopic.hpp"
#include "LoanedSamples.hpp"
#include "status/DataState.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace dds::inline sonopose_psm::sub {

namespace qos {
using DataReaderQos =
    core::detail::EntityQos<core::detail::ReaderDefaults, core::policy::UserData, core::policy::Durability,
                            core::policy::Deadline, core::policy::LatencyBudget, core::policy::Liveliness,
                            core::policy::Reliability, core::policy::History, core::policy::ResourceLimits,
                            core::policy::Ownership>;
}

template <class T>
class DataReader;

/// Callbacks of a reader. The contract:
/// - They run on threads of Cyclone DDS: data of other processes on its one receive thread, data of this
///   process on the writing thread, deadlines and liveliness on others. They must take microseconds, not
///   block, not throw (the process ends), and neither create nor end entities.
/// - A callback may run before the constructor of the reader has returned. Samples can be taken then, but the
///   instance handle of the reader is still nil.
/// - The listener must outlive its reader, whose end waits for a running callback (Entity::close).
/// - A status that a listener handles does not wake a `WaitSet`.
template <class T>
class DataReaderListener {
public:
  virtual ~DataReaderListener() = default;
  virtual void on_requested_deadline_missed(DataReader<T>& reader,
                                            const core::status::RequestedDeadlineMissedStatus& status) = 0;
  virtual void on_requested_incompatible_qos(DataReader<T>& reader,
                                             const core::status::RequestedIncompatibleQosStatus& status) = 0;
  virtual void on_sample_rejected(DataReader<T>& reader,
                                  const core::status::SampleRejectedStatus& status) = 0;
  virtual void on_liveliness_changed(DataReader<T>& reader,
                                     const core::status::LivelinessChangedStatus& status) = 0;
  virtual void on_data_available(DataReader<T>& reader) = 0;
  virtual void on_subscription_matched(DataReader<T>& reader,
                                       const core::status::SubscriptionMatchedStatus& status) = 0;
  virtual void on_sample_lost(DataReader<T>& reader, const core::status::SampleLostStatus& status) = 0;
};

/// A listener whose callbacks do nothing.
template <class T>
class NoOpDataReaderListener : public virtual DataReaderListener<T> {
public:
  void on_requested_deadline_missed(DataReader<T>&,
                                    const core::status::RequestedDeadlineMissedStatus&) override {}
  void on_requested_incompatible_qos(DataReader<T>&,
                                     const core::status::RequestedIncompatibleQosStatus&) override {}
  void on_sample_rejected(DataReader<T>&, const core::status::SampleRejectedStatus&) override {}
  void on_liveliness_changed(DataReader<T>&, const core::status::LivelinessChangedStatus&) override {}
  void on_data_available(DataReader<T>&) override {}
  void on_subscription_matched(DataReader<T>&, const core::status::SubscriptionMatchedStatus&) override {}
  void on_sample_lost(DataReader<T>&, const core::status::SampleLostStatus&) override {}
};

namespace detail {

class SubscriberNode : public core::detail::Node {
public:
  using Node::Node;

  qos::SubscriberQos qos;
};

class ReaderNode : public core::detail::EndpointNode {
public:
  using EndpointNode::EndpointNode;

  qos::DataReaderQos qos;
  status::DataState filter_state;
};

std::shared_ptr<ReaderNode> make_node(const core::Reference& subscriber, const core::Reference& topic,
                                      const qos::DataReaderQos& qos);
/// Makes the reader of a node.
void open(ReaderNode& reader, const core::detail::Callbacks& callbacks);

/// Samples to read or take.
struct Selection {
  bool take = false;
  bool of_one_instance = false;
  dds_instance_handle_t instance = DDS_HANDLE_NIL;
  std::uint32_t mask = DDS_ANY_STATE;
  std::uint32_t max_samples = static_cast<std::uint32_t>(core::LENGTH_UNLIMITED);
};

/// Samples in C that were read or taken, in memory that was zero before.
class Fetched {
public:
  Fetched(const core::detail::Node& reader, const Selection& selection, const dds_topic_descriptor_t& type);
  Fetched(const Fetched&) = delete;
  Fetched& operator=(const Fetched&) = delete;
  ~Fetched();

  std::size_t size() const { return infos_.size(); }
  const void* sample(std::size_t i) const { return &memory_[i * type_.m_size]; }
  const dds_sample_info_t& info(std::size_t i) const { return infos_[i]; }

private:
  const dds_topic_descriptor_t& type_;
  std::vector<std::byte> memory_;
  std::vector<dds_sample_info_t> infos_;
};

}  // namespace detail

/// Groups readers that share a partition.
class Subscriber : public core::Entity {
public:
  Subscriber(core::null_type) : Entity(core::null) {}
  explicit Subscriber(std::shared_ptr<core::detail::Node> node) : Entity(std::move(node)) {}
  Subscriber(const domain::DomainParticipant& participant);
  Subscriber(const domain::DomainParticipant& participant, const qos::SubscriberQos& qos);

  const qos::SubscriberQos& qos() const { return node<detail::SubscriberNode>().qos; }
  void qos(const qos::SubscriberQos& qos);
  qos::DataReaderQos default_datareader_qos() const { return {}; }
  const domain::DomainParticipant participant() const { return domain::DomainParticipant(node().owner()); }
};

/// A reader of any type.
class AnyDataReader : public core::Entity {
public:
  AnyDataReader(core::null_type) : Entity(core::null) {}
  explicit AnyDataReader(std::shared_ptr<core::detail::Node> node) : Entity(std::move(node)) {}

  const Subscriber subscriber() const { return Subscriber(node().owner()); }
  const topic::TopicDescription topic_description() const {
    return topic::TopicDescription(node<detail::ReaderNode>().topic);
  }
  qos::DataReaderQos qos() const { return node<detail::ReaderNode>().qos; }
  /// Throws ImmutablePolicyError for what an existing reader cannot change.
  void qos(const qos::DataReaderQos& qos);
  /// Throws TimeoutError unless the transient-local samples from before this reader arrive within `timeout`.
  void wait_for_historical_data(const core::Duration& timeout);

  core::status::LivelinessChangedStatus liveliness_changed_status() {
    return read_status<core::status::LivelinessChangedStatus>(dds_get_liveliness_changed_status);
  }
  core::status::SampleRejectedStatus sample_rejected_status() {
    return read_status<core::status::SampleRejectedStatus>(dds_get_sample_rejected_status);
  }
  core::status::SampleLostStatus sample_lost_status() {
    return read_status<core::status::SampleLostStatus>(dds_get_sample_lost_status);
  }
  core::status::RequestedDeadlineMissedStatus requested_deadline_missed_status() {
    return read_status<core::status::RequestedDeadlineMissedStatus>(dds_get_requested_deadline_missed_status);
  }
  core::status::RequestedIncompatibleQosStatus requested_incompatible_qos_status() {
    return read_status<core::status::RequestedIncompatibleQosStatus>(
        dds_get_requested_incompatible_qos_status);
  }
  core::status::SubscriptionMatchedStatus subscription_matched_status() {
    return read_status<core::status::SubscriptionMatchedStatus>(dds_get_subscription_matched_status);
  }
};

/// Reads samples of one type.
template <class T>
class DataReader : public AnyDataReader {
  using C = typename topic::detail::TypeSupport<T>::C;

public:
  using Listener = DataReaderListener<T>;

  /// Restricts one read or take.
  class Selector {
  public:
    explicit Selector(DataReader& reader) : reader_(core::detail::Access::node(reader)) {
      selection_.mask = reader.default_filter_state().c_mask();
    }
    Selector& instance(const core::InstanceHandle& instance) {
      selection_.of_one_instance = true;
      selection_.instance = instance.c_value();
      return *this;
    }
    Selector& state(const status::DataState& state) {
      selection_.mask = state.c_mask();
      return *this;
    }
    Selector& max_samples(std::uint32_t count) {
      selection_.max_samples = count;
      return *this;
    }
    LoanedSamples<T> read() {
      selection_.take = false;
      return fetch(*reader_, selection_);
    }
    LoanedSamples<T> take() {
      selection_.take = true;
      return fetch(*reader_, selection_);
    }

  private:
    std::shared_ptr<core::detail::Node> reader_;
    detail::Selection selection_;
  };

  DataReader(core::null_type) : AnyDataReader(core::null) {}
  explicit DataReader(std::shared_ptr<core::detail::Node> node) : AnyDataReader(std::move(node)) {}
  DataReader(const Subscriber& subscriber, const topic::Topic<T>& topic)
      : DataReader(subscriber, topic, qos::DataReaderQos()) {}
  DataReader(const Subscriber& subscriber, const topic::Topic<T>& topic, const qos::DataReaderQos& qos,
             DataReaderListener<T>* listener = nullptr,
             const core::status::StatusMask& mask = core::status::StatusMask::none())
      : AnyDataReader(detail::make_node(subscriber, topic, qos)) {
    auto& reader = node<detail::ReaderNode>();
    reader.listener = listener;
    detail::open(reader, callbacks(reader, mask));
  }

  /// Default selection of read, take and select: everything.
  status::DataState default_filter_state() { return node<detail::ReaderNode>().filter_state; }
  DataReader& default_filter_state(const status::DataState& state) {
    node<detail::ReaderNode>().filter_state = state;
    return *this;
  }

  /// Samples stay in the reader.
  LoanedSamples<T> read() { return select().read(); }
  /// Takes samples out of the reader.
  LoanedSamples<T> take() { return select().take(); }
  Selector select() { return Selector(*this); }

  /// Sets the key fields of `key` to those of an instance.
  T& key_value(T& key, const core::InstanceHandle& instance) {
    topic::detail::read_key<T>(node().handle(), instance, key);
    return key;
  }
  /// Nil for an unknown instance.
  const core::InstanceHandle lookup_instance(const T& key) const {
    return core::InstanceHandle(dds_lookup_instance(node().handle(), topic::detail::AsC<T>(key).get()));
  }

  void listener(DataReaderListener<T>* listener, const core::status::StatusMask& mask) {
    auto& reader = node<detail::ReaderNode>();
    core::detail::listen(reader, listener, callbacks(reader, mask));
  }
  DataReaderListener<T>* listener() const {
    return static_cast<DataReaderListener<T>*>(node<detail::ReaderNode>().listener.load());
  }

private:
  static core::detail::Callbacks callbacks(detail::ReaderNode& reader, const core::status::StatusMask& mask) {
    using Mask = core::status::StatusMask;
    core::detail::Callbacks all(reader, mask);
    all.add<&Listener::on_data_available>(Mask::data_available(), dds_lset_data_available);
    all.add<&Listener::on_sample_lost>(Mask::sample_lost(), dds_lset_sample_lost);
    all.add<&Listener::on_sample_rejected>(Mask::sample_rejected(), dds_lset_sample_rejected);
    all.add<&Listener::on_liveliness_changed>(Mask::liveliness_changed(), dds_lset_liveliness_changed);
    all.add<&Listener::on_subscription_matched>(Mask::subscription_matched(), dds_lset_subscription_matched);
    all.add<&Listener::on_requested_deadline_missed>(Mask::requested_deadline_missed(),
                                                     dds_lset_requested_deadline_missed);
    all.add<&Listener::on_requested_incompatible_qos>(Mask::requested_incompatible_qos(),
                                                      dds_lset_requested_incompatible_qos);
    return all;
  }

  static LoanedSamples<T> fetch(const core::detail::Node& reader, const detail::Selection& selection) {
    using Support = topic::detail::TypeSupport<T>;
    const auto fetched = std::make_shared<detail::Fetched>(reader, selection, Support::descriptor());
    std::vector<SampleRef<T>> samples;
    samples.reserve(fetched->size());
    for (std::size_t i = 0; i < fetched->size(); ++i) {
      const C& c = *static_cast<const C*>(fetched->sample(i));
      const SampleInfo info(fetched->info(i));
      if constexpr (topic::detail::Native<T>) {
        samples.emplace_back(c, info);
      } else {
        T data;
        topic::detail::copy_from_c<T>(c, data);
        samples.emplace_back(std::move(data), info);
      }
    }
    // Keeps the memory that native samples point to.
    if constexpr (topic::detail::Native<T>) return LoanedSamples<T>(std::move(samples), fetched);
    return LoanedSamples<T>(std::move(samples));
  }
};

namespace cond {

/// True while a reader has samples of the given state.
class ReadCondition : public core::cond::Condition {
public:
  ReadCondition(core::null_type) : Condition(core::null) {}
  ReadCondition(const AnyDataReader& reader, const status::DataState& state);
  template <class Functor>
  ReadCondition(const AnyDataReader& reader, const status::DataState& state, Functor functor)
      : ReadCondition(reader, state) {
    handler(std::move(functor));
  }
  const status::DataState state_filter() const;
  const AnyDataReader data_reader() const { return AnyDataReader(node().owner()); }
};

}  // namespace cond
}  // namespace dds::inline sonopose_psm::sub
