#pragma once
/// \file
/// Topics of types that the generator made from an IDL file. Left out: listeners, filtered and built-in
/// topics, AnyTopic, TopicInstance, is_topic_type, discovery, other names of a type.

#include "../core/detail/EntityQos.hpp"
#include "../domain/ddsdomain.hpp"
#include "detail/TypeSupport.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace dds::inline sonopose_psm::topic {

/// The name of a type on the wire.
template <class T>
struct topic_type_name {
  static std::string value() { return detail::TypeSupport<T>::descriptor().m_typename; }
};

namespace detail {
class TopicNode : public core::detail::Node {
public:
  using Node::Node;

  std::string name;
  std::string type_name;
  qos::TopicQos qos;

  void add_user(const std::shared_ptr<core::detail::Node>& endpoint);
  void check_unused() override;

private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<core::detail::Node>> users_;  // guarded by mutex_
};

std::shared_ptr<TopicNode> make_topic(const domain::DomainParticipant& participant, const std::string& name,
                                      const dds_topic_descriptor_t& type, const qos::TopicQos& qos);
}  // namespace detail

/// Name and type of a topic.
class TopicDescription : public core::Reference {
public:
  TopicDescription(core::null_type) {}
  explicit TopicDescription(std::shared_ptr<core::detail::Node> node) : Reference(std::move(node)) {}

  const std::string& name() const { return node<detail::TopicNode>().name; }
  const std::string& type_name() const { return node<detail::TopicNode>().type_name; }
  const domain::DomainParticipant domain_participant() const {
    return domain::DomainParticipant(node().owner());
  }
};

/// A named stream of one type.
template <class T>
class Topic : public core::Entity {
public:
  using DataType = T;

  Topic(core::null_type) : Entity(core::null) {}
  explicit Topic(std::shared_ptr<core::detail::Node> node) : Entity(std::move(node)) {}
  Topic(const domain::DomainParticipant& participant, const std::string& name)
      : Topic(participant, name, qos::TopicQos()) {}
  Topic(const domain::DomainParticipant& participant, const std::string& name, const qos::TopicQos& qos)
      : Entity(detail::make_topic(participant, name, detail::TypeSupport<T>::descriptor(), qos)) {}

  operator TopicDescription() const { return TopicDescription(pointer()); }
  const std::string& name() const { return node<detail::TopicNode>().name; }
  const std::string& type_name() const { return node<detail::TopicNode>().type_name; }
  qos::TopicQos qos() const { return node<detail::TopicNode>().qos; }
  const domain::DomainParticipant domain_participant() const {
    return domain::DomainParticipant(node().owner());
  }
};

}  // namespace dds::inline sonopose_psm::topic
