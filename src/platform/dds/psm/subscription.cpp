// Readers. Their callbacks are those of the C++ layer below.

#include "dds/psm/masks.hpp"
#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/psm/dds/sub/ddssub.hpp>

#include <dds/ddsc/dds_internal_api.h>

#include <algorithm>

namespace dds::inline sonopose_psm::sub {
namespace {

namespace own = sonopose::dds;
using core::detail::Access;
using core::detail::check;

struct AnyRead {};

/// Passes callbacks on.
class ReaderBridge : public own::DataReaderListener<AnyRead> {
public:
  ReaderBridge(detail::ReaderNode& reader, std::shared_ptr<detail::ReaderEvents> events)
      : reader_(reader), events_(std::move(events)) {}

  void on_data_available(own::DataReader<AnyRead>& reader) noexcept override {
    reader_.handle(reader.handle());  // the constructor may not have returned yet
    events_->on_data(reader_);
  }
  void on_subscription_matched(own::DataReader<AnyRead>& reader,
                               const own::SubscriptionMatchedStatus& status) noexcept override {
    pass<core::status::SubscriptionMatchedStatus>(reader, status);
  }
  void on_requested_deadline_missed(own::DataReader<AnyRead>& reader,
                                    const own::RequestedDeadlineMissedStatus& status) noexcept override {
    pass<core::status::RequestedDeadlineMissedStatus>(reader, status);
  }
  void on_requested_incompatible_qos(own::DataReader<AnyRead>& reader,
                                     const own::RequestedIncompatibleQosStatus& status) noexcept override {
    pass<core::status::RequestedIncompatibleQosStatus>(reader, status);
  }
  void on_liveliness_changed(own::DataReader<AnyRead>& reader,
                             const own::LivelinessChangedStatus& status) noexcept override {
    pass<core::status::LivelinessChangedStatus>(reader, status);
  }
  void on_sample_lost(own::DataReader<AnyRead>& reader,
                      const own::SampleLostStatus& status) noexcept override {
    pass<core::status::SampleLostStatus>(reader, status);
  }
  void on_sample_rejected(own::DataReader<AnyRead>& reader,
                          const own::SampleRejectedStatus& status) noexcept override {
    pass<core::status::SampleRejectedStatus>(reader, status);
  }

private:
  template <class Status>
  void pass(const own::DataReader<AnyRead>& reader, const auto& status) {
    reader_.handle(reader.handle());
    events_->on(reader_, Status(status));
  }

  detail::ReaderNode& reader_;
  std::shared_ptr<detail::ReaderEvents> events_;
};

using Listener = std::pair<std::shared_ptr<ReaderBridge>, own::detail::CListener>;

Listener listener_of(detail::ReaderNode& reader, std::shared_ptr<detail::ReaderEvents> events,
                     const core::status::StatusMask& mask) {
  if (events == nullptr) return {};
  auto bridge = std::make_shared<ReaderBridge>(reader, std::move(events));
  own::DataReaderListener<AnyRead>* const listener = bridge.get();
  return {std::move(bridge), own::detail::c_listener(listener, own::StatusMask{core::detail::to_c(mask)})};
}

template <class Status, class C>
Status status_of(const char* name, dds_return_t (*call)(dds_entity_t, C*), dds_entity_t reader) {
  C status{};
  check(name, call(reader, &status));
  return Status(status);
}

}  // namespace

namespace detail {

std::shared_ptr<ReaderNode> make_reader(const core::Reference& subscriber, const core::Reference& topic,
                                        const qos::DataReaderQos& qos, std::shared_ptr<ReaderEvents> events,
                                        const core::status::StatusMask& mask) {
  auto node = core::detail::Node::make<ReaderNode>(Access::owner(subscriber));
  node->topic = Access::owner(topic);
  node->qos = qos;
  const auto [bridge, listener] = listener_of(*node, std::move(events), mask);
  node->bridge = bridge;
  node->handle(check("dds_create_reader", static_cast<const topic::detail::TopicNode&>(*node->topic).name,
                     dds_create_reader(Access::handle(subscriber), node->topic->handle(), qos.c_qos().get(),
                                       listener.get())));
  static_cast<topic::detail::TopicNode&>(*node->topic).add_user(node);
  return node;
}

void listen(ReaderNode& reader, std::shared_ptr<ReaderEvents> events, const core::status::StatusMask& mask) {
  const auto [bridge, listener] = listener_of(reader, std::move(events), mask);
  check("dds_set_listener", dds_set_listener(reader.handle(), listener.get()));
  reader.bridge = bridge;
}

Fetched::Fetched(const core::detail::Node& node, const Selection& selection,
                 const dds_topic_descriptor_t& type)
    : type_(type) {
  if (selection.of_one_instance && selection.instance == DDS_HANDLE_NIL) {
    throw core::PreconditionNotMetError("nil is no instance to read");
  }
  if (selection.max_samples == 0) return;
  const core::detail::Pin pin(node);  // an entity that ends meanwhile would stay locked
  const dds_entity_t reader = node.handle();
  const std::uint32_t available = dds_reader_lock_samples(reader);  // locks only if there are any
  if (available == 0) return;
  const std::uint32_t size = std::min({available, selection.max_samples, 0x7fffffffU});
  std::vector<void*> samples;
  try {
    memory_ = std::make_unique<std::byte[]>(std::size_t{size} * type.m_size);
    infos_.resize(size);
    for (std::size_t i = 0; i < size; ++i) samples.push_back(&memory_[i * type.m_size]);
  } catch (...) {
    void* none = this;
    dds_sample_info_t info;  // NOLINT(*-member-init): no instance has this handle, so the call only unlocks
    dds_read_instance_mask(reader, &none, &info, 1, DDS_READ_WITHOUT_LOCK, ~dds_instance_handle_t{0}, 0);
    throw;
  }
  const auto call = [&](auto all, auto of_instance) -> dds_return_t {
    return selection.of_one_instance
               ? of_instance(reader, samples.data(), infos_.data(), size, DDS_READ_WITHOUT_LOCK,
                             selection.instance, selection.mask)
               : all(reader, samples.data(), infos_.data(), size, DDS_READ_WITHOUT_LOCK, selection.mask);
  };
  const dds_return_t count = selection.take ? call(dds_take_mask, dds_take_instance_mask)
                                            : call(dds_read_mask, dds_read_instance_mask);
  infos_.resize(static_cast<std::size_t>(check(selection.take ? "dds_take" : "dds_read", count)));
}

Fetched::~Fetched() {
  if ((type_.m_flagset & DDS_TOPIC_FIXED_SIZE) != 0) return;
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    dds_sample_free(&memory_[i * type_.m_size], &type_, DDS_FREE_CONTENTS);
  }
}

}  // namespace detail

void AnyDataReader::wait_for_historical_data(const core::Duration& timeout) {
  check("dds_reader_wait_for_historical_data",
        dds_reader_wait_for_historical_data(node().handle(), core::detail::to_c(timeout)));
}

core::status::LivelinessChangedStatus AnyDataReader::liveliness_changed_status() {
  return status_of<core::status::LivelinessChangedStatus>("dds_get_liveliness_changed_status",
                                                          dds_get_liveliness_changed_status, node().handle());
}
core::status::SampleRejectedStatus AnyDataReader::sample_rejected_status() {
  return status_of<core::status::SampleRejectedStatus>("dds_get_sample_rejected_status",
                                                       dds_get_sample_rejected_status, node().handle());
}
core::status::SampleLostStatus AnyDataReader::sample_lost_status() {
  return status_of<core::status::SampleLostStatus>("dds_get_sample_lost_status", dds_get_sample_lost_status,
                                                   node().handle());
}
core::status::RequestedDeadlineMissedStatus AnyDataReader::requested_deadline_missed_status() {
  return status_of<core::status::RequestedDeadlineMissedStatus>(
      "dds_get_requested_deadline_missed_status", dds_get_requested_deadline_missed_status, node().handle());
}
core::status::RequestedIncompatibleQosStatus AnyDataReader::requested_incompatible_qos_status() {
  return status_of<core::status::RequestedIncompatibleQosStatus>("dds_get_requested_incompatible_qos_status",
                                                                 dds_get_requested_incompatible_qos_status,
                                                                 node().handle());
}
core::status::SubscriptionMatchedStatus AnyDataReader::subscription_matched_status() {
  return status_of<core::status::SubscriptionMatchedStatus>(
      "dds_get_subscription_matched_status", dds_get_subscription_matched_status, node().handle());
}

}  // namespace dds::inline sonopose_psm::sub
