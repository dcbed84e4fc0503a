// Writers. Their callbacks are those of the C++ layer below.

#include "dds/psm/masks.hpp"
#include <sonopose/dds/binding/data_writer.hpp>
#include <sonopose/dds/psm/dds/pub/ddspub.hpp>

namespace dds::inline sonopose_psm::pub {
namespace {

namespace own = sonopose::dds;
using core::detail::Access;
using core::detail::check;

struct AnyWritten {};

/// Passes callbacks on.
class WriterBridge : public own::DataWriterListener<AnyWritten> {
public:
  WriterBridge(detail::WriterNode& writer, std::shared_ptr<detail::WriterEvents> events)
      : writer_(writer), events_(std::move(events)) {}

  void on_publication_matched(own::DataWriter<AnyWritten>& writer,
                              const own::PublicationMatchedStatus& status) noexcept override {
    pass<core::status::PublicationMatchedStatus>(writer, status);
  }
  void on_offered_deadline_missed(own::DataWriter<AnyWritten>& writer,
                                  const own::OfferedDeadlineMissedStatus& status) noexcept override {
    pass<core::status::OfferedDeadlineMissedStatus>(writer, status);
  }
  void on_offered_incompatible_qos(own::DataWriter<AnyWritten>& writer,
                                   const own::OfferedIncompatibleQosStatus& status) noexcept override {
    pass<core::status::OfferedIncompatibleQosStatus>(writer, status);
  }
  void on_liveliness_lost(own::DataWriter<AnyWritten>& writer,
                          const own::LivelinessLostStatus& status) noexcept override {
    pass<core::status::LivelinessLostStatus>(writer, status);
  }

private:
  template <class Status>
  void pass(const own::DataWriter<AnyWritten>& writer, const auto& status) {
    writer_.handle(writer.handle());  // the constructor may not have returned yet
    events_->on(writer_, Status(status));
  }

  detail::WriterNode& writer_;
  std::shared_ptr<detail::WriterEvents> events_;
};

using Listener = std::pair<std::shared_ptr<WriterBridge>, own::detail::CListener>;

Listener listener_of(detail::WriterNode& writer, std::shared_ptr<detail::WriterEvents> events,
                     const core::status::StatusMask& mask) {
  if (events == nullptr) return {};
  auto bridge = std::make_shared<WriterBridge>(writer, std::move(events));
  own::DataWriterListener<AnyWritten>* const listener = bridge.get();
  return {std::move(bridge), own::detail::c_listener(listener, own::StatusMask{core::detail::to_c(mask)})};
}

template <class Status, class C>
Status status_of(const char* name, dds_return_t (*call)(dds_entity_t, C*), dds_entity_t writer) {
  C status{};
  check(name, call(writer, &status));
  return Status(status);
}

}  // namespace

namespace detail {

std::shared_ptr<WriterNode> make_writer(const core::Reference& publisher, const core::Reference& topic,
                                        const qos::DataWriterQos& qos, std::shared_ptr<WriterEvents> events,
                                        const core::status::StatusMask& mask) {
  auto node = core::detail::Node::make<WriterNode>(Access::owner(publisher));
  node->topic = Access::owner(topic);
  node->qos = qos;
  const auto [bridge, listener] = listener_of(*node, std::move(events), mask);
  node->bridge = bridge;
  node->handle(check("dds_create_writer", static_cast<const topic::detail::TopicNode&>(*node->topic).name,
                     dds_create_writer(Access::handle(publisher), node->topic->handle(), qos.c_qos().get(),
                                       listener.get())));
  static_cast<topic::detail::TopicNode&>(*node->topic).add_user(node);
  return node;
}

void listen(WriterNode& writer, std::shared_ptr<WriterEvents> events, const core::status::StatusMask& mask) {
  const auto [bridge, listener] = listener_of(writer, std::move(events), mask);
  check("dds_set_listener", dds_set_listener(writer.handle(), listener.get()));
  writer.bridge = bridge;
}

}  // namespace detail

const core::status::LivelinessLostStatus AnyDataWriter::liveliness_lost_status() {
  return status_of<core::status::LivelinessLostStatus>("dds_get_liveliness_lost_status",
                                                       dds_get_liveliness_lost_status, node().handle());
}
const core::status::OfferedDeadlineMissedStatus AnyDataWriter::offered_deadline_missed_status() {
  return status_of<core::status::OfferedDeadlineMissedStatus>(
      "dds_get_offered_deadline_missed_status", dds_get_offered_deadline_missed_status, node().handle());
}
const core::status::OfferedIncompatibleQosStatus AnyDataWriter::offered_incompatible_qos_status() {
  return status_of<core::status::OfferedIncompatibleQosStatus>(
      "dds_get_offered_incompatible_qos_status", dds_get_offered_incompatible_qos_status, node().handle());
}
const core::status::PublicationMatchedStatus AnyDataWriter::publication_matched_status() {
  return status_of<core::status::PublicationMatchedStatus>(
      "dds_get_publication_matched_status", dds_get_publication_matched_status, node().handle());
}

}  // namespace dds::inline sonopose_psm::pub
