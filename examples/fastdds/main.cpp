// A peer of ROS 2 nodes in Fast DDS, on loopback: listens to a topic, or writes messages to one. The domain
// is ROS_DOMAIN_ID.
//
//   fastdds_peer listen rt/hedge_7/odom odometry [COUNT] [--best-effort] [--bits]
//   fastdds_peer send rt/imu imu COUNT [BITS ...]
//
// `listen` prints each sample as one line and exits after COUNT. `send` sends 100 messages per second,
// fills their fields cyclically with the given doubles (hexadecimal bits; default 1.0), and prints the same
// lines.

#include "diagnostic_msgsPubSubTypes.h"
#include "geometry_msgsPubSubTypes.h"
#include "message_filling.hpp"
#include "message_text.hpp"
#include "nav_msgsPubSubTypes.h"
#include "peer.hpp"
#include "px4_msgsPubSubTypes.h"
#include "rmw_dds_commonPubSubTypes.h"
#include "rosgraph_msgsPubSubTypes.h"
#include "sensor_msgsPubSubTypes.h"
#include "tf2_msgsPubSubTypes.h"

#include <chrono>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using eprosima::fastrtps::types::ReturnCode_t;

struct ListenOptions {
  std::uint64_t count = 0;  ///< 0: forever
  bool best_effort = false;
  bool bits = false;
};

template <class PubSubType>
void listen(const std::string& topic, const ListenOptions& options) {
  Peer peer(new PubSubType, topic);
  DataReader* const reader = peer.reader(options.best_effort);
  std::cerr << "listening to " << topic << std::endl;
  typename PubSubType::type sample;
  SampleInfo info;
  for (std::uint64_t seen = 0; options.count == 0 || seen < options.count;) {
    reader->wait_for_unread_message({1, 0});
    while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || (options.count != 0 && seen == options.count)) continue;
      std::cout << text_of(sample, options.bits) << std::endl;
      ++seen;
    }
  }
}

template <class PubSubType>
void send(const std::string& topic, std::uint64_t count, MessageFiller filler) {
  using namespace std::chrono_literals;
  Peer peer(new PubSubType, topic);
  DataWriter* const writer = peer.writer();
  PublicationMatchedStatus matched;
  while (writer->get_publication_matched_status(matched), matched.current_count == 0) {
    std::this_thread::sleep_for(10ms);
  }
  for (std::uint64_t sent = 0; sent < count; ++sent) {
    typename PubSubType::type message;
    filler.fill(message);
    if (!writer->write(&message)) throw std::runtime_error("the sample was not written");
    std::cout << text_of(message, true) << std::endl;
    std::this_thread::sleep_for(10ms);
  }
  if (writer->wait_for_acknowledgments({10, 0}) != ReturnCode_t::RETCODE_OK) {
    throw std::runtime_error("the reader has not acknowledged all samples");
  }
}

void listen(const std::string& topic, const std::string& type, const ListenOptions& options) {
  if (type == "imu") return listen<sensor_msgs::msg::dds_::Imu_PubSubType>(topic, options);
  if (type == "odometry") return listen<nav_msgs::msg::dds_::Odometry_PubSubType>(topic, options);
  if (type == "tf") return listen<tf2_msgs::msg::dds_::TFMessage_PubSubType>(topic, options);
  if (type == "diagnostics") {
    return listen<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(topic, options);
  }
  if (type == "pose")
    return listen<geometry_msgs::msg::dds_::PoseWithCovarianceStamped_PubSubType>(topic, options);
  if (type == "point") return listen<geometry_msgs::msg::dds_::PointStamped_PubSubType>(topic, options);
  if (type == "mag") return listen<sensor_msgs::msg::dds_::MagneticField_PubSubType>(topic, options);
  if (type == "path") return listen<nav_msgs::msg::dds_::Path_PubSubType>(topic, options);
  if (type == "px4_odometry") return listen<px4_msgs::msg::dds_::VehicleOdometry_PubSubType>(topic, options);
  if (type == "discovery")
    return listen<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>(topic, options);
  throw std::invalid_argument("the type is '" + type +
                              "': it is imu, odometry, tf, diagnostics, pose, point, mag, path, "
                              "px4_odometry or discovery");
}

void send(const std::string& type, const std::string& topic, std::uint64_t count,
          const MessageFiller& filler) {
  if (type == "imu") return send<sensor_msgs::msg::dds_::Imu_PubSubType>(topic, count, filler);
  if (type == "point") return send<geometry_msgs::msg::dds_::PointStamped_PubSubType>(topic, count, filler);
  if (type == "pose")
    return send<geometry_msgs::msg::dds_::PoseWithCovarianceStamped_PubSubType>(topic, count, filler);
  if (type == "tf") return send<tf2_msgs::msg::dds_::TFMessage_PubSubType>(topic, count, filler);
  if (type == "clock") return send<rosgraph_msgs::msg::dds_::Clock_PubSubType>(topic, count, filler);
  if (type == "timesync") return send<px4_msgs::msg::dds_::TimesyncStatus_PubSubType>(topic, count, filler);
  throw std::invalid_argument("the type is '" + type + "': it is imu, point, pose, tf, clock or timesync");
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
        options.count = number("COUNT", arguments[i]);
      }
    }
    listen(arguments[1], arguments[2], options);
    return 0;
  }
  if (arguments.size() >= 4 && arguments[0] == "send") {
    Bits bits;
    for (std::size_t i = 4; i < arguments.size(); ++i) bits.push_back(number("BITS", arguments[i], 16));
    send(arguments[2], arguments[1], number("COUNT", arguments[3]), MessageFiller(bits));
    return 0;
  }
  std::cerr << "fastdds_peer listen TOPIC imu|odometry|tf|diagnostics|pose|point|mag|path|px4_odometry|"
               "discovery [COUNT] "
               "[--best-effort] [--bits]\n"
               "fastdds_peer send TOPIC imu|point|pose|tf|clock|timesync COUNT [BITS ...]\n";
  return 2;
} catch (const std::exception& error) {
  std::cerr << "fastdds_peer: " << error.what() << '\n';
  return 1;
}
