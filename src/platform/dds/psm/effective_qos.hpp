#pragma once
// The QoS of an entity as Cyclone DDS completed it: from the topic, and with its defaults.

#include <sonopose/dds/psm/dds/core/Entity.hpp>
#include <sonopose/dds/psm/dds/core/detail/EntityQos.hpp>

namespace dds::inline sonopose_psm::core::detail {

/// Reads the QoS of a reader or writer.
template <class EndpointNode>
void read_qos(EndpointNode& node) {
  const CQos qos = make_qos();
  check("dds_get_qos", dds_get_qos(node.handle(), qos.get()));
  node.qos = decltype(node.qos)::of_c(qos.get());
}

}  // namespace dds::inline sonopose_psm::core::detail
