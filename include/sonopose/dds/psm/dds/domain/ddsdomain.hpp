#pragma once
/// \file
/// Participants. Left out: their listeners, assert_liveliness, and to set what new entities have by default.
///
/// A participant joins the domain as the programs of sonopose do: on loopback, unless CYCLONEDDS_URI names
/// interfaces, and with the security that the variables of ROS 2 ask for. <sonopose/dds/psm/ext.hpp> joins it
/// otherwise.

#include "../core/Entity.hpp"
#include "../core/detail/EntityQos.hpp"

#include <dds/dds.h>

#include <cstdint>
#include <memory>
#include <utility>

namespace dds::inline sonopose_psm {

namespace domain::qos {
using DomainParticipantQos =
    core::detail::EntityQos<core::detail::ParticipantDefaults, core::policy::UserData>;
}
namespace pub::qos {
using PublisherQos = core::detail::EntityQos<core::detail::PublisherDefaults, core::policy::Partition>;
}
namespace sub::qos {
using SubscriberQos = core::detail::EntityQos<core::detail::SubscriberDefaults, core::policy::Partition>;
}

namespace topic::qos {
using TopicQos =
    core::detail::EntityQos<core::detail::TopicDefaults, core::policy::Durability,
                            core::policy::DurabilityService, core::policy::Deadline,
                            core::policy::LatencyBudget, core::policy::Liveliness, core::policy::Reliability,
                            core::policy::History, core::policy::ResourceLimits,
                            core::policy::TransportPriority, core::policy::Lifespan, core::policy::Ownership>;
}

namespace domain {

namespace detail {
class ParticipantNode : public core::detail::Node {
public:
  using Node::Node;

  std::uint32_t domain_id = 0;
  qos::DomainParticipantQos qos;
  core::policy::Partition partition;  ///< default of publishers and subscribers
  std::shared_ptr<void> membership;   ///< keeps the entity and its domain

protected:
  void end(dds_entity_t) noexcept override { membership.reset(); }
};
}  // namespace detail

/// A membership of this process in a domain.
class DomainParticipant : public core::Entity {
public:
  DomainParticipant(core::null_type) : Entity(core::null) {}
  explicit DomainParticipant(std::shared_ptr<core::detail::Node> node) : Entity(std::move(node)) {}

  /// For default_id(), the domain is ROS_DOMAIN_ID, otherwise 0. Throws InvalidArgumentError for an id above
  /// 232.
  DomainParticipant(std::uint32_t id);
  DomainParticipant(std::uint32_t id, const qos::DomainParticipantQos& qos);

  std::uint32_t domain_id() const { return node<detail::ParticipantNode>().domain_id; }
  const qos::DomainParticipantQos& qos() const { return node<detail::ParticipantNode>().qos; }
  void qos(const qos::DomainParticipantQos& qos);
  core::Time current_time() const { return core::detail::to_time(dds_time()); }

  static qos::DomainParticipantQos default_participant_qos() { return {}; }
  pub::qos::PublisherQos default_publisher_qos() const;
  sub::qos::SubscriberQos default_subscriber_qos() const;
  topic::qos::TopicQos default_topic_qos() const { return {}; }
};

}  // namespace domain
}  // namespace dds::inline sonopose_psm

namespace org::eclipse::cyclonedds::domain::inline sonopose_psm {
/// The id that stands for the user's choice. With cyclonedds-cxx, this is the domain in CYCLONEDDS_URI.
inline std::uint32_t default_id() {
  return DDS_DOMAIN_DEFAULT;
}
}  // namespace org::eclipse::cyclonedds::domain::inline sonopose_psm
