#pragma once
/// \file
/// A named stream of one type.

#include <sonopose/dds/entity.hpp>
#include <sonopose/dds/error.hpp>
#include <sonopose/dds/participant.hpp>

#include <dds/dds.h>

#include <string>

namespace sonopose::dds {

/// Says which descriptor belongs to a type that idlc generated. Specialise it with a static function
/// `const dds_topic_descriptor_t& descriptor()`.
template <class T>
struct TopicTraits;

/// Several topics of one name may live in a participant. A writer or reader keeps what it needs of its topic,
/// which may go before it.
template <class T>
class Topic : public Entity {
public:
  Topic(const DomainParticipant& participant, const std::string& name, const Qos& qos = {})
      : Entity(check("dds_create_topic", name,
                     dds_create_topic(participant.handle(), &TopicTraits<T>::descriptor(), name.c_str(),
                                      qos.get(), nullptr))),
        name_(name) {}

  const std::string& name() const noexcept { return name_; }

private:
  std::string name_;
};

}  // namespace sonopose::dds
