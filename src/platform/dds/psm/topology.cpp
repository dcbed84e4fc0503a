// Participants, topics, publishers, subscribers and writers.

#include "dds/psm/effective_qos.hpp"
#include <sonopose/dds/psm/ext.hpp>

namespace dds::inline sonopose_psm {
namespace {

using core::detail::Access;
using core::detail::check;

sonopose::dds::DomainOptions options_for(std::uint32_t id) {
  sonopose::dds::DomainOptions options;
  if (id != DDS_DOMAIN_DEFAULT) options.domain_id = id;
  return options;
}

/// Makes a publisher or subscriber.
template <class Node, class Qos, class Create>
std::shared_ptr<Node> make_group(const domain::DomainParticipant& participant, const Qos& qos,
                                 const char* name, Create create) {
  auto node = core::detail::Node::make<Node>(Access::owner(participant));
  node->qos = qos;
  node->handle(check(name, create(Access::handle(participant), qos.c_qos().get(), nullptr)));
  return node;
}

/// Changes the QoS of an existing entity.
template <class Node, class Qos>
void change_qos(Node& node, const Qos& qos) {
  check("dds_set_qos", dds_set_qos(node.handle(), qos.c_qos().get()));
  node.qos = qos;
}

}  // namespace

namespace domain {

DomainParticipant::DomainParticipant(std::uint32_t id) : DomainParticipant(id, default_participant_qos()) {}

DomainParticipant::DomainParticipant(std::uint32_t id, const qos::DomainParticipantQos& qos)
    : DomainParticipant(
          sonopose::dds::ext::participant(options_for(id), sonopose::dds::Qos(qos.c_qos().get()))) {}

void DomainParticipant::qos(const qos::DomainParticipantQos& qos) {
  change_qos(node<detail::ParticipantNode>(), qos);
}

pub::qos::PublisherQos DomainParticipant::default_publisher_qos() const {
  return pub::qos::PublisherQos() << node<detail::ParticipantNode>().partition;
}

sub::qos::SubscriberQos DomainParticipant::default_subscriber_qos() const {
  return sub::qos::SubscriberQos() << node<detail::ParticipantNode>().partition;
}

}  // namespace domain

namespace topic::detail {

void TopicNode::add_user(const std::shared_ptr<core::detail::Node>& endpoint) {
  const std::lock_guard lock(mutex_);
  std::erase_if(users_, [](const auto& user) { return user.expired(); });
  users_.push_back(endpoint);
}

void TopicNode::check_unused() {
  std::vector<std::shared_ptr<core::detail::Node>> users;  // end after the lock, if they are the last ones
  const std::lock_guard lock(mutex_);
  for (const auto& each : users_) {
    users.push_back(each.lock());
    if (users.back() == nullptr || users.back()->is_closed()) continue;
    throw core::PreconditionNotMetError("the topic " + name + " has open readers or writers");
  }
}

std::shared_ptr<TopicNode> make_topic(const domain::DomainParticipant& participant, const std::string& name,
                                      const dds_topic_descriptor_t& type, const qos::TopicQos& qos) {
  auto node = core::detail::Node::make<TopicNode>(Access::owner(participant));
  node->name = name;
  node->type_name = type.m_typename;
  node->qos = qos;
  node->handle(
      check("dds_create_topic", name,
            dds_create_topic(Access::handle(participant), &type, name.c_str(), qos.c_qos().get(), nullptr)));
  return node;
}

}  // namespace topic::detail

namespace pub {

std::shared_ptr<detail::WriterNode> detail::make_node(const core::Reference& publisher,
                                                      const core::Reference& topic,
                                                      const qos::DataWriterQos& qos) {
  return core::detail::make_endpoint<WriterNode>(publisher, topic, qos);
}

void detail::open(WriterNode& writer, const core::detail::Callbacks& callbacks) {
  core::detail::open_endpoint(writer, "dds_create_writer", dds_create_writer, callbacks);
}

Publisher::Publisher(const domain::DomainParticipant& participant)
    : Publisher(participant, participant.default_publisher_qos()) {}

Publisher::Publisher(const domain::DomainParticipant& participant, const qos::PublisherQos& qos)
    : Entity(make_group<detail::PublisherNode>(participant, qos, "dds_create_publisher",
                                               dds_create_publisher)) {}

void Publisher::qos(const qos::PublisherQos& qos) {
  change_qos(node<detail::PublisherNode>(), qos);
}

void AnyDataWriter::qos(const qos::DataWriterQos& qos) {
  change_qos(node<detail::WriterNode>(), qos);
  core::detail::read_qos(node<detail::WriterNode>());
}

}  // namespace pub

namespace sub {

Subscriber::Subscriber(const domain::DomainParticipant& participant)
    : Subscriber(participant, participant.default_subscriber_qos()) {}

Subscriber::Subscriber(const domain::DomainParticipant& participant, const qos::SubscriberQos& qos)
    : Entity(make_group<detail::SubscriberNode>(participant, qos, "dds_create_subscriber",
                                                dds_create_subscriber)) {}

void Subscriber::qos(const qos::SubscriberQos& qos) {
  change_qos(node<detail::SubscriberNode>(), qos);
}

void AnyDataReader::qos(const qos::DataReaderQos& qos) {
  change_qos(node<detail::ReaderNode>(), qos);
  core::detail::read_qos(node<detail::ReaderNode>());
}

}  // namespace sub
}  // namespace dds::inline sonopose_psm
