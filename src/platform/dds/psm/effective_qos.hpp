#pragma once
// Readers and writers, and their QoS as Cyclone DDS completed it: from the topic, and with its defaults.

#include <sonopose/dds/psm/dds/core/Entity.hpp>
#include <sonopose/dds/psm/dds/core/detail/Callbacks.hpp>
#include <sonopose/dds/psm/dds/core/detail/EntityQos.hpp>
#include <sonopose/dds/psm/dds/topic/ddstopic.hpp>

#include <memory>

namespace dds::inline sonopose_psm::core::detail {

/// Reads the QoS of a reader or writer.
template <class EndpointNode>
void read_qos(EndpointNode& node) {
  const CQos qos = make_qos();
  check("dds_get_qos", dds_get_qos(node.handle(), qos.get()));
  node.qos = decltype(node.qos)::of_c(qos.get());
}

/// Makes the node of a reader or writer. `owner`: its subscriber or publisher.
template <class N, class Qos>
std::shared_ptr<N> make_endpoint(const Reference& owner, const Reference& topic, const Qos& qos) {
  auto node = Node::make<N>(Access::owner(owner));
  node->topic = Access::owner(topic);
  node->qos = qos;
  return node;
}

/// Makes the reader or writer of a node. `name`: that of the function `create`.
template <class N, class Create>
void open_endpoint(N& node, const char* name, Create create, const Callbacks& callbacks) {
  auto& topic = static_cast<topic::detail::TopicNode&>(*node.topic);
  node.handle(check(name, topic.name,
                    create(node.owner()->handle(), topic.handle(), node.qos.c_qos().get(),
                           node.listener == nullptr ? nullptr : callbacks.c())));
  topic.add_user(node.shared_from_this());
  read_qos(node);
}

}  // namespace dds::inline sonopose_psm::core::detail
