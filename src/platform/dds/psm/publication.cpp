// Writers.

#include "dds/psm/effective_qos.hpp"
#include <sonopose/dds/psm/dds/pub/ddspub.hpp>

namespace dds::inline sonopose_psm::pub::detail {

using core::detail::Access;
using core::detail::check;

std::shared_ptr<WriterNode> make_node(const core::Reference& publisher, const core::Reference& topic,
                                      const qos::DataWriterQos& qos) {
  auto node = core::detail::Node::make<WriterNode>(Access::owner(publisher));
  node->topic = Access::owner(topic);
  node->qos = qos;
  return node;
}

void open(WriterNode& writer, const core::detail::Callbacks& callbacks) {
  auto& topic = static_cast<topic::detail::TopicNode&>(*writer.topic);
  writer.handle(check("dds_create_writer", topic.name,
                      dds_create_writer(writer.owner()->handle(), topic.handle(), writer.qos.c_qos().get(),
                                        writer.listener == nullptr ? nullptr : callbacks.c())));
  topic.add_user(writer.shared_from_this());
  core::detail::read_qos(writer);
}

}  // namespace dds::inline sonopose_psm::pub::detail
