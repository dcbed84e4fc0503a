// A consumer of ROS 2's nav_msgs/Odometry without ROS: prints the position of the robot. The argument is the
// number of poses to print; default unlimited.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/names.hpp>

#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
  namespace ros2 = sonopose::ros2;
  const long max_poses = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 0;

  const dds::domain::DomainParticipant participant(org::eclipse::cyclonedds::domain::default_id());
  const dds::topic::Topic<ros2::Odometry> topic(participant, ros2::name_in_dds("/hedge_7/odom"));
  // The default QoS of a ROS 2 subscription.
  dds::sub::qos::DataReaderQos qos;
  qos << dds::core::policy::Reliability::Reliable() << dds::core::policy::History::KeepLast(10);
  dds::sub::DataReader<ros2::Odometry> reader(dds::sub::Subscriber(participant), topic, qos);
  const dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;

  for (long seen = 0; max_poses == 0 || seen < max_poses;) {
    waitset.wait();
    for (const auto& sample : reader.take()) {
      if (!sample.info().valid()) continue;
      const ros2::Odometry& odometry = sample.data();
      const ros2::Point& position = odometry.pose.pose.position;
      std::cout << odometry.child_frame_id << " in " << odometry.header.frame_id << ": " << position.x << ' '
                << position.y << ' ' << position.z << '\n';
      ++seen;
    }
  }
}
