#pragma once
/// \file
/// A ROS 2 node that is visible to ROS 2 tools (`ros2 node list`, `ros2 topic info -v`): endpoints announce
/// the hash of their type, and the topic `ros_discovery_info` assigns them to the node. Source:
/// rmw_dds_common.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/node/qos_overrides.hpp>
#include <sonopose/ros2/node/service.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sonopose::ros2 {

inline constexpr const char* discovery_topic = "ros_discovery_info";

/// Layout of `ros_discovery_info`: a `Gid` has 24 bytes up to Humble and 16 bytes later. A process of Iron or
/// later does not list a node that is announced in Humble's layout; one of Humble fails to list any node if
/// one is announced in the later layout.
enum class Distro : std::uint8_t {
  humble,  ///< Humble and earlier
  jazzy    ///< Iron and later
};

/// QoS of a participant of ROS 2 in an enclave (an absolute name).
dds::Qos participant_qos(const std::string& enclave = "/");

/// A node in the ROS 2 graph. Not thread-safe. The destructor withdraws its announcement.
class Node {
public:
  /// `qos` must outlive the node.
  Node(dds::domain::DomainParticipant participant, const dds::qos::Provider& qos, NameResolver names,
       Distro layout, QosOverrides overrides = {});
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();

  const NameResolver& names() const noexcept { return names_; }
  const dds::domain::DomainParticipant& participant() const noexcept { return participant_; }

  /// Makes a writer of a topic by its ROS name, which is resolved, with a profile of the QoS file
  /// ("ros2::Default"). `listener` must outlive it. The next announce() assigns it to this node.
  template <class T>
  dds::pub::DataWriter<T> make_writer(const std::string& name, const char* profile,
                                      dds::pub::DataWriterListener<T>* listener = nullptr) {
    return make_writer_in_dds<T>(name_in_dds(names_.topic(name)), profile, {}, listener);
  }

  /// Makes a reader likewise. `mask`: the statuses of the listener.
  template <class T>
  dds::sub::DataReader<T> make_reader(
      const std::string& name, const char* profile, dds::sub::DataReaderListener<T>* listener = nullptr,
      dds::core::status::StatusMask mask = dds::core::status::StatusMask::all()) {
    return make_reader_in_dds<T>(name_in_dds(names_.topic(name)), profile, {}, listener, mask);
  }

  /// Makes a service by its ROS name, which is resolved like that of a topic. `on_request` is called when a
  /// request arrives, under the rules of a listener.
  template <class S>
  Service<S> make_service(const std::string& name, std::function<void()> on_request = {}) {
    using Listener = typename Service<S>::RequestListener;
    const char* const profile = "ros2::Default";
    const std::string service = names_.topic(name);
    const std::string id = next_service_id();
    auto listener = on_request ? std::make_unique<Listener>(std::move(on_request)) : nullptr;
    auto requests =
        make_reader_in_dds<typename S::Request>("rq" + service + "Request", profile, id, listener.get());
    return {std::move(listener), std::move(requests),
            make_writer_in_dds<typename S::Response>("rr" + service + "Reply", profile, id)};
  }

  /// Changes the layout from the next announce() on. Returns true if it was another one. Throws
  /// dds::core::Exception.
  bool use_layout(Distro layout);

  /// Publishes node and endpoints if they have changed since the last call.
  void announce();

  /// Removes a reader or writer. Call this before closing it, and announce() afterwards.
  void remove(const dds::core::Entity& endpoint);
  /// Removes both endpoints of a service.
  template <class S>
  void remove(const Service<S>& service) {
    remove(service.requests());
    remove(service.replies());
  }

  /// True if another participant has announced a node of the same name since the last call. ROS 2 then shows
  /// only one of them.
  bool found_namesake();

private:
  using Guids = std::vector<dds_guid_t>;

  /// Endpoints of `ros_discovery_info`.
  template <class Info>
  struct Discovery {
    dds::pub::DataWriter<Info> writer;
    dds::sub::DataReader<Info> reader;
  };

  /// `prefix`: user data before the hash of the type.
  template <class T>
  dds::pub::DataWriter<T> make_writer_in_dds(const std::string& name, const char* profile,
                                             const std::string& prefix,
                                             dds::pub::DataWriterListener<T>* listener = nullptr) {
    const dds::topic::Topic<T> topic(participant_, name, qos_.topic_qos(profile));
    dds::Qos qos = with_type_hash<T>(qos_.datawriter_qos(profile), prefix);
    overrides_.apply(name_without_prefix(name), QosOverrides::Endpoint::publisher, qos);
    const dds::pub::Publisher publisher(participant_, qos);
    dds::pub::DataWriter<T> writer(publisher, topic, qos, listener, dds::core::status::StatusMask::all());
    add(writers_, writer);
    return writer;
  }
  template <class T>
  dds::sub::DataReader<T> make_reader_in_dds(
      const std::string& name, const char* profile, const std::string& prefix,
      dds::sub::DataReaderListener<T>* listener = nullptr,
      dds::core::status::StatusMask mask = dds::core::status::StatusMask::all()) {
    const dds::topic::Topic<T> topic(participant_, name, qos_.topic_qos(profile));
    dds::Qos qos = with_type_hash<T>(qos_.datareader_qos(profile), prefix);
    overrides_.apply(name_without_prefix(name), QosOverrides::Endpoint::subscription, qos);
    const dds::sub::Subscriber subscriber(participant_, qos);
    dds::sub::DataReader<T> reader(subscriber, topic, qos, listener, mask);
    add(readers_, reader);
    return reader;
  }

  /// "/odom" from "rt/odom". Names of services differ from those of all topics.
  static std::string name_without_prefix(const std::string& name) {
    return name.substr(std::min(name.size(), name.find('/')));
  }
  template <class T>
  static dds::Qos with_type_hash(const dds::Qos& qos, const std::string& prefix = {}) {
    return add_type_hash(qos, dds::TopicTraits<T>::descriptor().m_typename, prefix);
  }
  static dds::Qos add_type_hash(dds::Qos qos, const char* type_name, const std::string& prefix);
  /// User data by which clients associate the two endpoints of a service: "serviceid=…;".
  std::string next_service_id();
  void add(Guids& guids, const dds::core::Entity& endpoint);
  void join_discovery();
  template <class Info>
  Discovery<Info> make_discovery(const dds::Qos& writer_qos, const dds::Qos& reader_qos) const;
  template <class Action>
  void with_discovery(const Action& action);
  void write_info(const NodeName* node);

  dds::domain::DomainParticipant participant_;
  const dds::qos::Provider& qos_;
  NameResolver names_;
  Distro layout_;
  QosOverrides overrides_;
  Guids readers_;
  Guids writers_;
  bool changed_ = true;
  std::uint32_t service_count_ = 0;
  std::variant<std::monostate, Discovery<ParticipantEntitiesInfo>, Discovery<HumbleParticipantEntitiesInfo>>
      discovery_;
};

}  // namespace sonopose::ros2
