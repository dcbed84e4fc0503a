#pragma once
/// \file
/// A topic: a named stream of one type.

#include <sonopose/dds/binding/entity.hpp>
#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/participant.hpp>

#include <dds/dds.h>

#include <string>

namespace sonopose::dds {

/// Descriptor of a type that idlc generated. Specialise it with a static function `const
/// dds_topic_descriptor_t& descriptor()`.
template <class T>
struct TopicTraits;

/// The same type under another name on the wire, without the type information, which contains the old name.
inline dds_topic_descriptor_t renamed(const dds_topic_descriptor_t& descriptor, const char* type_name) {
  return {.m_size = descriptor.m_size,
          .m_align = descriptor.m_align,
          .m_flagset = descriptor.m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
          .m_nkeys = descriptor.m_nkeys,
          .m_typename = type_name,
          .m_keys = descriptor.m_keys,
          .m_nops = descriptor.m_nops,
          .m_ops = descriptor.m_ops,
          .m_meta = descriptor.m_meta,
          .type_information = {},
          .type_mapping = {},
          .restrict_data_representation = descriptor.restrict_data_representation};
}

/// A topic of a participant, which may have several of one name. It may be destroyed before its writers and
/// readers.
template <class T>
class Topic : public Entity {
public:
  Topic(const DomainParticipant& participant, const std::string& name, const Qos& qos = {})
      : Entity(check("dds_create_topic", name,
                     dds_create_topic(participant.handle(), &TopicTraits<T>::descriptor(), name.c_str(),
                                      qos.get(), nullptr))),
        name_(name) {}

  const std::string& name() const noexcept { return name_; }

  /// Restricts readers made with this topic from now on to samples for which `accepts(sample, argument)` is
  /// true. It is called on the receive thread, before an instance is made. `argument` must outlive the
  /// readers. `sample` is a const T*.
  void set_filter(bool (*accepts)(const void* sample, void* argument), void* argument) {
    check("dds_set_topic_filter_and_arg", name_, dds_set_topic_filter_and_arg(handle(), accepts, argument));
  }

private:
  std::string name_;
};

}  // namespace sonopose::dds
