// A neighbour of ROS 2 nodes in Fast DDS, on this machine's loopback: listens to a topic, or writes IMU
// samples to one. The domain is ROS_DOMAIN_ID.
//
//   fastdds_peer listen rt/hedge_7/odom odometry [COUNT] [--best-effort] [--bits]
//   fastdds_peer send-imu rt/imu COUNT [BITS ...]
//
// `listen` prints each sample as one line and ends after COUNT; `send-imu` goes round the given doubles
// (hexadecimal bits; 1.0) for the fields of its samples, 100 a second, and prints these lines too.

#include "diagnostic_msgsPubSubTypes.h"
#include "message_text.hpp"
#include "nav_msgsPubSubTypes.h"
#include "sensor_msgsPubSubTypes.h"
#include "tf2_msgsPubSubTypes.h"

#include <chrono>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;
using Bits = std::vector<std::uint64_t>;

/// UDP on loopback, without shared memory and multicast: the participants are looked for at the ports that
/// the first ones of a domain have.
DomainParticipantQos loopback_qos() {
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
  return qos;
}

/// What has not come is thrown.
template <class Entity>
Entity* made(Entity* entity, const char* what) {
  if (entity == nullptr) throw std::runtime_error(std::string("Fast DDS made no ") + what);
  return entity;
}

/// One topic of one type in the domain of ROS_DOMAIN_ID, with the QoS that ROS 2's nodes have by default.
class Neighbour {
public:
  Neighbour(TopicDataType* type_of_our_own, const std::string& topic)
      : type_(type_of_our_own),
        participant_(
            made(DomainParticipantFactory::get_instance()->create_participant(domain(), loopback_qos()),
                 "participant")) {
    type_.register_type(participant_);
    topic_ = made(participant_->create_topic(topic, type_.get_type_name(), TOPIC_QOS_DEFAULT), "topic");
  }
  Neighbour(const Neighbour&) = delete;
  Neighbour& operator=(const Neighbour&) = delete;
  ~Neighbour() {
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
    return id == nullptr ? 0 : static_cast<std::uint32_t>(std::strtoul(id, nullptr, 10));
  }

  TypeSupport type_;
  DomainParticipant* participant_;
  Topic* topic_ = nullptr;
};

struct ListenOptions {
  long count = 0;  ///< 0: for ever
  bool best_effort = false;
  bool bits = false;
};

template <class PubSubType>
void listen(const std::string& topic, const ListenOptions& options) {
  Neighbour neighbour(new PubSubType, topic);
  DataReader* const reader = neighbour.reader(options.best_effort);
  std::cerr << "listening to " << topic << std::endl;
  typename PubSubType::type sample;
  SampleInfo info;
  for (long seen = 0; options.count == 0 || seen < options.count;) {
    reader->wait_for_unread_message({1, 0});
    while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || (options.count != 0 && seen == options.count)) continue;
      std::cout << text_of(sample, options.bits) << std::endl;
      ++seen;
    }
  }
}

/// Goes round the doubles that it was given.
class Numbers {
public:
  explicit Numbers(Bits bits)
      : bits_(bits.empty() ? Bits{std::bit_cast<std::uint64_t>(1.0)} : std::move(bits)) {}
  double next() { return std::bit_cast<double>(bits_[next_++ % bits_.size()]); }

private:
  Bits bits_;
  std::size_t next_ = 0;
};

sensor_msgs::msg::dds_::Imu_ make_imu(Numbers& numbers) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto now_s = std::chrono::duration_cast<std::chrono::seconds>(now);
  sensor_msgs::msg::dds_::Imu_ imu;
  imu.header().stamp().sec(static_cast<std::int32_t>(now_s.count()));
  imu.header().stamp().nanosec(static_cast<std::uint32_t>(std::chrono::nanoseconds(now - now_s).count()));
  imu.header().frame_id("imu_link");
  auto& q = imu.orientation();
  for (double* const field : {&q.x(), &q.y(), &q.z(), &q.w()}) *field = numbers.next();
  for (double& field : imu.orientation_covariance()) field = numbers.next();
  auto& rate = imu.angular_velocity();
  for (double* const field : {&rate.x(), &rate.y(), &rate.z()}) *field = numbers.next();
  for (double& field : imu.angular_velocity_covariance()) field = numbers.next();
  auto& force = imu.linear_acceleration();
  for (double* const field : {&force.x(), &force.y(), &force.z()}) *field = numbers.next();
  for (double& field : imu.linear_acceleration_covariance()) field = numbers.next();
  return imu;
}

void send_imu(const std::string& topic, long count, Numbers numbers) {
  using namespace std::chrono_literals;
  Neighbour neighbour(new sensor_msgs::msg::dds_::Imu_PubSubType, topic);
  DataWriter* const writer = neighbour.writer();
  PublicationMatchedStatus matched;
  while (writer->get_publication_matched_status(matched), matched.current_count == 0) {
    std::this_thread::sleep_for(10ms);
  }
  for (long sent = 0; sent < count; ++sent) {
    auto imu = make_imu(numbers);
    if (!writer->write(&imu)) throw std::runtime_error("the sample was not written");
    std::cout << text_of(imu, true) << std::endl;
    std::this_thread::sleep_for(10ms);
  }
  if (writer->wait_for_acknowledgments({10, 0}) != ReturnCode_t::RETCODE_OK) {
    throw std::runtime_error("the reader has not got everything");
  }
}

void listen(const std::string& topic, const std::string& type, const ListenOptions& options) {
  if (type == "imu") return listen<sensor_msgs::msg::dds_::Imu_PubSubType>(topic, options);
  if (type == "odometry") return listen<nav_msgs::msg::dds_::Odometry_PubSubType>(topic, options);
  if (type == "tf") return listen<tf2_msgs::msg::dds_::TFMessage_PubSubType>(topic, options);
  if (type == "diagnostics") {
    return listen<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(topic, options);
  }
  throw std::invalid_argument("the type is '" + type + "': it is imu, odometry, tf or diagnostics");
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() >= 3 && arguments[0] == "listen") {
    ListenOptions options;
    for (std::size_t i = 3; i < arguments.size(); ++i) {
      if (arguments[i] == "--best-effort") {
        options.best_effort = true;
      } else if (arguments[i] == "--bits") {
        options.bits = true;
      } else {
        options.count = std::stol(arguments[i]);
      }
    }
    listen(arguments[1], arguments[2], options);
    return 0;
  }
  if (arguments.size() >= 3 && arguments[0] == "send-imu") {
    Bits bits;
    for (std::size_t i = 3; i < arguments.size(); ++i) bits.push_back(std::stoull(arguments[i], nullptr, 16));
    send_imu(arguments[1], std::stol(arguments[2]), Numbers(bits));
    return 0;
  }
  std::cerr << "fastdds_peer listen TOPIC imu|odometry|tf|diagnostics [COUNT] [--best-effort] [--bits]\n"
               "fastdds_peer send-imu TOPIC COUNT [BITS ...]\n";
  return 2;
} catch (const std::exception& error) {
  std::cerr << "fastdds_peer: " << error.what() << '\n';
  return 1;
}
