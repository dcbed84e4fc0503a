// A peer of ROS 2 nodes in Fast DDS, on loopback: listens to a topic, or writes IMU samples to one. The
// domain is ROS_DOMAIN_ID.
//
//   fastdds_peer listen rt/hedge_7/odom odometry [COUNT] [--best-effort] [--bits]
//   fastdds_peer send-imu rt/imu COUNT [BITS ...]
//
// `listen` prints each sample as one line and exits after COUNT. `send-imu` sends 100 samples per second,
// fills their fields cyclically with the given doubles (hexadecimal bits; default 1.0), and prints the same
// lines.

#include "diagnostic_msgsPubSubTypes.h"
#include "message_text.hpp"
#include "nav_msgsPubSubTypes.h"
#include "peer.hpp"
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
using Bits = std::vector<std::uint64_t>;

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

/// Cycles through the given doubles.
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

void send_imu(const std::string& topic, std::uint64_t count, Numbers numbers) {
  using namespace std::chrono_literals;
  Peer peer(new sensor_msgs::msg::dds_::Imu_PubSubType, topic);
  DataWriter* const writer = peer.writer();
  PublicationMatchedStatus matched;
  while (writer->get_publication_matched_status(matched), matched.current_count == 0) {
    std::this_thread::sleep_for(10ms);
  }
  for (std::uint64_t sent = 0; sent < count; ++sent) {
    auto imu = make_imu(numbers);
    if (!writer->write(&imu)) throw std::runtime_error("the sample was not written");
    std::cout << text_of(imu, true) << std::endl;
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
        options.count = number("COUNT", arguments[i]);
      }
    }
    listen(arguments[1], arguments[2], options);
    return 0;
  }
  if (arguments.size() >= 3 && arguments[0] == "send-imu") {
    Bits bits;
    for (std::size_t i = 3; i < arguments.size(); ++i) bits.push_back(number("BITS", arguments[i], 16));
    send_imu(arguments[1], number("COUNT", arguments[2]), Numbers(bits));
    return 0;
  }
  std::cerr << "fastdds_peer listen TOPIC imu|odometry|tf|diagnostics [COUNT] [--best-effort] [--bits]\n"
               "fastdds_peer send-imu TOPIC COUNT [BITS ...]\n";
  return 2;
} catch (const std::exception& error) {
  std::cerr << "fastdds_peer: " << error.what() << '\n';
  return 1;
}
