#pragma once
/// \file
/// A Fast DDS participant that discovers ROS 2 nodes and sonopose on loopback.

#include <cstdint>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <memory>
#include <stdexcept>
#include <string>

using namespace eprosima::fastdds::dds;

/// A whole number, of decimal or of hexadecimal digits alone.
inline std::uint64_t number(const std::string& name, const std::string& text, int base = 10) {
  const char* const digits = base == 16 ? "0123456789abcdef" : "0123456789";
  if (text.empty() || text.size() > 16 || text.find_first_not_of(digits) != std::string::npos) {
    throw std::invalid_argument(name + " is '" + text + "': 1 to 16 of the digits " + digits + " are needed");
  }
  return std::stoull(text, nullptr, base);
}

/// Adds the files of the enclave ROS_SECURITY_ENCLAVE_OVERRIDE in the key store ROS_SECURITY_KEYSTORE, if
/// ROS_SECURITY_ENABLE is true. An enclave of `sonopose-security enclave` needs `--fastdds`.
inline void secure(DomainParticipantQos& qos) {
  const auto variable = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  if (variable("ROS_SECURITY_ENABLE") != "true") return;
  const std::string folder = "file://" + variable("ROS_SECURITY_KEYSTORE") + "/enclaves/" +
                             variable("ROS_SECURITY_ENCLAVE_OVERRIDE") + "/";
  auto& properties = qos.properties().properties();
  const std::string identity = "dds.sec.auth.builtin.PKI-DH.";
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  properties.emplace_back(identity + "identity_ca", folder + "identity_ca.cert.pem");
  properties.emplace_back(identity + "identity_certificate", folder + "cert.pem");
  properties.emplace_back(identity + "private_key", folder + "key.pem");
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  properties.emplace_back(access + "permissions_ca", folder + "permissions_ca.cert.pem");
  properties.emplace_back(access + "governance", folder + "governance.p7s");
  properties.emplace_back(access + "permissions", folder + "permissions.p7s");
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

/// UDP on loopback, without shared memory and multicast. Discovery uses the unicast ports of the first
/// participants of a domain.
inline DomainParticipantQos loopback_qos() {
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  udp->maxInitialPeersRange = 20;
  eprosima::fastrtps::rtps::Locator_t all_ports;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(all_ports, "127.0.0.1");
  DomainParticipantQos qos;
  qos.name("fastdds_peer");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  qos.wire_protocol().builtin.initialPeersList.push_back(all_ports);
  secure(qos);
  return qos;
}

/// Throws if the entity was not created.
template <class Entity>
Entity* made(Entity* entity, const char* what) {
  if (entity == nullptr) throw std::runtime_error(std::string("Fast DDS did not create the ") + what);
  return entity;
}

/// One topic of one type in the domain of ROS_DOMAIN_ID, with the default QoS of ROS 2 nodes.
class Peer {
public:
  Peer(TopicDataType* owned_type, const std::string& topic)
      : type_(owned_type),
        participant_(
            made(DomainParticipantFactory::get_instance()->create_participant(domain(), loopback_qos()),
                 "participant")) {
    type_.register_type(participant_);
    topic_ = made(participant_->create_topic(topic, type_.get_type_name(), TOPIC_QOS_DEFAULT), "topic");
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  ~Peer() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  /// Reliable, volatile, the last ten; or as for sensor data: best effort, the last five.
  DataReader* reader(bool sensor_data) {
    DataReaderQos qos;
    qos.reliability().kind = sensor_data ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
    qos.history().depth = sensor_data ? 5 : 10;
    qos.data_sharing().off();
    Subscriber* const subscriber =
        made(participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT), "subscriber");
    return made(subscriber->create_datareader(topic_, qos), "reader");
  }

  /// Reliable, volatile, the last ten.
  DataWriter* writer() {
    DataWriterQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().depth = 10;
    qos.durability().kind = VOLATILE_DURABILITY_QOS;
    qos.data_sharing().off();
    Publisher* const publisher = made(participant_->create_publisher(PUBLISHER_QOS_DEFAULT), "publisher");
    return made(publisher->create_datawriter(topic_, qos), "writer");
  }

private:
  static std::uint32_t domain() {
    const char* const id = std::getenv("ROS_DOMAIN_ID");
    return id == nullptr ? 0 : static_cast<std::uint32_t>(number("ROS_DOMAIN_ID", id));
  }

  TypeSupport type_;
  DomainParticipant* participant_;
  Topic* topic_ = nullptr;
};
