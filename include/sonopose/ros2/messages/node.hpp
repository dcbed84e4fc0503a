#pragma once
/// \file
/// A ROS 2 node as others see it (`ros2 node list`, `ros2 topic info -v`): its endpoints carry the hash of
/// their type, and the topic `ros_discovery_info` says whose they are. Source: rmw_dds_common.

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/data_writer.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/service.hpp>

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace sonopose::ros2 {

/// Which layout `ros_discovery_info` has: a `Gid` is 24 bytes long up to Humble and 16 later. A node that
/// speaks the other one works all the same, but `ros2 node list` does not show it.
enum class Distro : std::uint8_t {
  humble,  ///< and before
  jazzy    ///< Iron and later
};

/// Says of a participant that it belongs to ROS 2 and to this enclave: absolute, as "/".
dds::Qos participant_qos(const std::string& enclave = "/");

/// For one thread at a time. The node vanishes from the others' lists with this object.
class Node {
public:
  /// `participant` and `qos` must outlive it.
  Node(const dds::DomainParticipant& participant, const dds::QosProvider& qos, NameResolver names,
       Distro distro);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  Node(Node&&) = delete;
  Node& operator=(Node&&) = delete;
  ~Node();

  const NameResolver& names() const noexcept { return names_; }

  /// A writer for a topic by its ROS name, which is resolved, with a profile of the QoS file
  /// ("ros2::Default"). `listener` must outlive it. Others learn that it is this node's by the next
  /// announce().
  template <class T>
  dds::DataWriter<T> make_writer(const std::string& name, const char* profile,
                                 dds::DataWriterListener<T>* listener = nullptr) {
    return make_writer_in_dds<T>(name_in_dds(names_.topic(name)), profile, {}, listener);
  }

  /// The same for a reader; its listener hears of the statuses in `mask`.
  template <class T>
  dds::DataReader<T> make_reader(const std::string& name, const char* profile,
                                 dds::DataReaderListener<T>* listener = nullptr,
                                 dds::StatusMask mask = dds::StatusMask::all()) {
    return make_reader_in_dds<T>(name_in_dds(names_.topic(name)), profile, {}, listener, mask);
  }

  /// A service by its ROS name, which is resolved as a topic's is.
  template <class S>
  Service<S> make_service(const std::string& name) {
    const char* const profile = "ros2::Default";
    const std::string service = names_.topic(name);
    const std::string id = next_service_id();
    return {make_reader_in_dds<typename S::Request>("rq" + service + "Request", profile, id),
            make_writer_in_dds<typename S::Response>("rr" + service + "Reply", profile, id)};
  }

  /// Tells the others of node and endpoints, if anything has changed since the last time.
  void announce();

  /// For a reader or writer that is about to go: call it before it is closed, and announce() after.
  void forget(const dds::Entity& endpoint);

private:
  using Guids = std::vector<dds_guid_t>;

  /// `before`: what stands in the user data before the type's hash.
  template <class T>
  dds::DataWriter<T> make_writer_in_dds(const std::string& name, const char* profile,
                                        const std::string& before,
                                        dds::DataWriterListener<T>* listener = nullptr) {
    const dds::Topic<T> topic(participant_, name, qos_.topic_qos(profile));
    dds::DataWriter<T> writer(participant_, topic, with_type_hash<T>(qos_.datawriter_qos(profile), before),
                              listener);
    note(writers_, writer);
    return writer;
  }
  template <class T>
  dds::DataReader<T> make_reader_in_dds(const std::string& name, const char* profile,
                                        const std::string& before,
                                        dds::DataReaderListener<T>* listener = nullptr,
                                        dds::StatusMask mask = dds::StatusMask::all()) {
    const dds::Topic<T> topic(participant_, name, qos_.topic_qos(profile));
    dds::DataReader<T> reader(participant_, topic, with_type_hash<T>(qos_.datareader_qos(profile), before),
                              listener, mask);
    note(readers_, reader);
    return reader;
  }

  template <class T>
  static dds::Qos with_type_hash(dds::Qos qos, const std::string& before = {}) {
    return add_type_hash(std::move(qos), dds::TopicTraits<T>::descriptor().m_typename, before);
  }
  static dds::Qos add_type_hash(dds::Qos qos, const char* type_name, const std::string& before);
  /// By which a client knows that a service's two ends belong together: "serviceid=…;".
  std::string next_service_id();
  void note(Guids& guids, const dds::Entity& endpoint);

  const dds::DomainParticipant& participant_;
  const dds::QosProvider& qos_;
  NameResolver names_;
  Guids readers_;
  Guids writers_;
  bool changed_ = true;
  std::uint32_t service_count_ = 0;
  std::variant<dds::DataWriter<ParticipantEntitiesInfo>, dds::DataWriter<HumbleParticipantEntitiesInfo>>
      discovery_;
};

}  // namespace sonopose::ros2
