// PX4's side of the agent, without PX4: sends its clock ten times a second, and prints the odometry that PX4
// would get. The argument is the number of messages to print; default unlimited.
//
//   examples/autopilot/drone.sh      # a simulated drone, its fusion, and the relay
//   sonopose_px4_side                # in another terminal
//
// With a real PX4 and its Micro-XRCE-DDS agent, `sonopose-ros2 --px4 /` needs neither.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/names.hpp>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
  namespace ros2 = sonopose::ros2;
  using namespace std::chrono;
  const long max_messages = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 0;

  const dds::domain::DomainParticipant participant(org::eclipse::cyclonedds::domain::default_id());
  const dds::topic::Topic<ros2::TimesyncStatus> clock_topic(participant,
                                                            ros2::name_in_dds("/fmu/out/timesync_status"));
  const dds::topic::Topic<ros2::VehicleOdometry> odometry_topic(
      participant, ros2::name_in_dds("/fmu/in/vehicle_visual_odometry"));
  // The QoS of PX4's client.
  dds::pub::qos::DataWriterQos writer_qos;
  writer_qos << dds::core::policy::Reliability::BestEffort() << dds::core::policy::History::KeepLast(5);
  dds::sub::qos::DataReaderQos reader_qos;
  reader_qos << dds::core::policy::Reliability::BestEffort() << dds::core::policy::History::KeepLast(5);
  dds::pub::DataWriter<ros2::TimesyncStatus> clock(dds::pub::Publisher(participant), clock_topic, writer_qos);
  dds::sub::DataReader<ros2::VehicleOdometry> reader(dds::sub::Subscriber(participant), odometry_topic,
                                                     reader_qos);
  const dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;

  auto due = steady_clock::now();
  for (long seen = 0; max_messages == 0 || seen < max_messages;) {
    if (steady_clock::now() >= due) {
      due += milliseconds(100);
      ros2::TimesyncStatus status{};
      status.timestamp = static_cast<std::uint64_t>(
          duration_cast<microseconds>(system_clock::now().time_since_epoch()).count());
      status.source_protocol = 2;  // DDS
      clock.write(status);
    }
    sonopose::dds::ext::wait(waitset, milliseconds(20));
    for (const auto& sample : reader.take()) {
      if (!sample.info().valid()) continue;
      const ros2::VehicleOdometry& odometry = sample.data();
      std::cout << (odometry.pose_frame == 1 ? "NED " : "FRD ") << odometry.position[0] << ' '
                << odometry.position[1] << ' ' << odometry.position[2] << " m, quality "
                << int{odometry.quality} << " %, resets " << int{odometry.reset_counter} << std::endl;
      ++seen;
    }
  }
}
