#pragma once
/// \file
/// Publishers and writers. Left out: listeners of publishers and of AnyDataWriter, acknowledgements,
/// assert_liveliness, coherent sets, suspended publications, TopicInstance, writing of ranges and pairs,
/// instances with a time stamp, `writer << qos`, to set default_datawriter_qos, discovery.

#include "../core/detail/Callbacks.hpp"
#include "../core/detail/EntityQos.hpp"
#include "../topic/ddstopic.hpp"

#include <memory>
#include <utility>

namespace dds::inline sonopose_psm::pub {

namespace qos {
using DataWriterQos =
    core::detail::EntityQos<core::detail::WriterDefaults, core::policy::UserData, core::policy::Durability,
                            core::policy::Deadline, core::policy::LatencyBudget, core::policy::Liveliness,
                            core::policy::Reliability, core::policy::History, core::policy::ResourceLimits,
                            core::policy::TransportPriority, core::policy::Lifespan, core::policy::Ownership,
                            core::policy::OwnershipStrength, core::policy::WriterDataLifecycle>;
}

template <class T>
class DataWriter;

/// Callbacks of a writer, under the contract of those of a reader (DataReaderListener).
template <class T>
class DataWriterListener {
public:
  virtual ~DataWriterListener() = default;
  virtual void on_offered_deadline_missed(DataWriter<T>& writer,
                                          const core::status::OfferedDeadlineMissedStatus& status) = 0;
  virtual void on_offered_incompatible_qos(DataWriter<T>& writer,
                                           const core::status::OfferedIncompatibleQosStatus& status) = 0;
  virtual void on_liveliness_lost(DataWriter<T>& writer,
                                  const core::status::LivelinessLostStatus& status) = 0;
  virtual void on_publication_matched(DataWriter<T>& writer,
                                      const core::status::PublicationMatchedStatus& status) = 0;
};

/// A listener whose callbacks do nothing.
template <class T>
class NoOpDataWriterListener : public virtual DataWriterListener<T> {
public:
  void on_offered_deadline_missed(DataWriter<T>&, const core::status::OfferedDeadlineMissedStatus&) override {
  }
  void on_offered_incompatible_qos(DataWriter<T>&,
                                   const core::status::OfferedIncompatibleQosStatus&) override {}
  void on_liveliness_lost(DataWriter<T>&, const core::status::LivelinessLostStatus&) override {}
  void on_publication_matched(DataWriter<T>&, const core::status::PublicationMatchedStatus&) override {}
};

namespace detail {

class PublisherNode : public core::detail::Node {
public:
  using Node::Node;

  qos::PublisherQos qos;
};

class WriterNode : public core::detail::EndpointNode {
public:
  using EndpointNode::EndpointNode;

  qos::DataWriterQos qos;
};

std::shared_ptr<WriterNode> make_node(const core::Reference& publisher, const core::Reference& topic,
                                      const qos::DataWriterQos& qos);
/// Makes the writer of a node.
void open(WriterNode& writer, const core::detail::Callbacks& callbacks);

}  // namespace detail

/// Groups writers that share a partition.
class Publisher : public core::Entity {
public:
  Publisher(core::null_type) : Entity(core::null) {}
  explicit Publisher(std::shared_ptr<core::detail::Node> node) : Entity(std::move(node)) {}
  Publisher(const domain::DomainParticipant& participant);
  Publisher(const domain::DomainParticipant& participant, const qos::PublisherQos& qos);

  const qos::PublisherQos& qos() const { return node<detail::PublisherNode>().qos; }
  void qos(const qos::PublisherQos& qos);
  qos::DataWriterQos default_datawriter_qos() const { return {}; }
  const domain::DomainParticipant participant() const { return domain::DomainParticipant(node().owner()); }
};

/// A writer of any type.
class AnyDataWriter : public core::Entity {
public:
  AnyDataWriter(core::null_type) : Entity(core::null) {}

  const Publisher publisher() const { return Publisher(node().owner()); }
  const topic::TopicDescription topic_description() const {
    return topic::TopicDescription(node<detail::WriterNode>().topic);
  }
  qos::DataWriterQos qos() const { return node<detail::WriterNode>().qos; }
  /// Throws ImmutablePolicyError for what an existing writer cannot change.
  void qos(const qos::DataWriterQos& qos);

  const core::status::LivelinessLostStatus liveliness_lost_status() {
    return read_status<core::status::LivelinessLostStatus>(dds_get_liveliness_lost_status);
  }
  const core::status::OfferedDeadlineMissedStatus offered_deadline_missed_status() {
    return read_status<core::status::OfferedDeadlineMissedStatus>(dds_get_offered_deadline_missed_status);
  }
  const core::status::OfferedIncompatibleQosStatus offered_incompatible_qos_status() {
    return read_status<core::status::OfferedIncompatibleQosStatus>(dds_get_offered_incompatible_qos_status);
  }
  const core::status::PublicationMatchedStatus publication_matched_status() {
    return read_status<core::status::PublicationMatchedStatus>(dds_get_publication_matched_status);
  }

protected:
  explicit AnyDataWriter(std::shared_ptr<core::detail::Node> node) : Entity(std::move(node)) {}
};

/// Writes samples of one type. `write` throws TimeoutError if slow readers block it for max_blocking_time.
template <class T>
class DataWriter : public AnyDataWriter {
  using AsC = topic::detail::AsC<T>;

public:
  using Listener = DataWriterListener<T>;

  DataWriter(core::null_type) : AnyDataWriter(core::null) {}
  explicit DataWriter(std::shared_ptr<core::detail::Node> node) : AnyDataWriter(std::move(node)) {}
  DataWriter(const Publisher& publisher, const topic::Topic<T>& topic)
      : DataWriter(publisher, topic, qos::DataWriterQos()) {}
  DataWriter(const Publisher& publisher, const topic::Topic<T>& topic, const qos::DataWriterQos& qos,
             DataWriterListener<T>* listener = nullptr,
             const core::status::StatusMask& mask = core::status::StatusMask::none())
      : AnyDataWriter(detail::make_node(publisher, topic, qos)) {
    auto& writer = node<detail::WriterNode>();
    writer.listener = listener;
    detail::open(writer, callbacks(writer, mask));
  }

  void write(const T& sample) { call("dds_write", dds_write, AsC(sample).get()); }
  /// The invalid time stands for now.
  void write(const T& sample, const core::Time& timestamp) {
    if (timestamp == core::Time::invalid()) return write(sample);
    call("dds_write_ts", dds_write_ts, AsC(sample).get(), core::detail::to_c(timestamp));
  }
  /// The sample must be of the instance.
  void write(const T& sample, const core::InstanceHandle&) { write(sample); }
  DataWriter& operator<<(const T& sample) {
    write(sample);
    return *this;
  }

  const core::InstanceHandle register_instance(const T& key) {
    dds_instance_handle_t instance = 0;
    call("dds_register_instance", dds_register_instance, &instance, AsC(key).get());
    return core::InstanceHandle(instance);
  }
  DataWriter& unregister_instance(const core::InstanceHandle& instance) {
    call("dds_unregister_instance_ih", dds_unregister_instance_ih, instance.c_value());
    return *this;
  }
  DataWriter& unregister_instance(const T& key) {
    call("dds_unregister_instance", dds_unregister_instance, AsC(key).get());
    return *this;
  }
  DataWriter& dispose_instance(const core::InstanceHandle& instance) {
    call("dds_dispose_ih", dds_dispose_ih, instance.c_value());
    return *this;
  }
  DataWriter& dispose_instance(const T& key) {
    call("dds_dispose", dds_dispose, AsC(key).get());
    return *this;
  }
  /// Nil for an unknown instance.
  core::InstanceHandle lookup_instance(const T& key) {
    return core::InstanceHandle(dds_lookup_instance(node().handle(), AsC(key).get()));
  }
  /// Sets the key fields of `key` to those of an instance.
  T& key_value(T& key, const core::InstanceHandle& instance) {
    topic::detail::read_key<T>(node().handle(), instance, key);
    return key;
  }

  const topic::Topic<T> topic() const { return topic::Topic<T>(node<detail::WriterNode>().topic); }

  void listener(DataWriterListener<T>* listener, const core::status::StatusMask& mask) {
    auto& writer = node<detail::WriterNode>();
    core::detail::listen(writer, listener, callbacks(writer, mask));
  }
  DataWriterListener<T>* listener() const {
    return static_cast<DataWriterListener<T>*>(node<detail::WriterNode>().listener.load());
  }

private:
  static core::detail::Callbacks callbacks(detail::WriterNode& writer, const core::status::StatusMask& mask) {
    using Mask = core::status::StatusMask;
    core::detail::Callbacks all(writer, mask);
    all.add<&Listener::on_liveliness_lost>(Mask::liveliness_lost(), dds_lset_liveliness_lost);
    all.add<&Listener::on_publication_matched>(Mask::publication_matched(), dds_lset_publication_matched);
    all.add<&Listener::on_offered_deadline_missed>(Mask::offered_deadline_missed(),
                                                   dds_lset_offered_deadline_missed);
    all.add<&Listener::on_offered_incompatible_qos>(Mask::offered_incompatible_qos(),
                                                    dds_lset_offered_incompatible_qos);
    return all;
  }

  template <class Function, class... Arguments>
  void call(const char* name, Function function, Arguments... arguments) {
    core::detail::check(name, function(node().handle(), arguments...));
  }
};

}  // namespace dds::inline sonopose_psm::pub
