// PX4's side of the agent, without PX4: sends its clock ten times a second, and prints the odometry that PX4
// would get. The argument is the number of messages to print; default unlimited.
//
//   examples/autopilot/drone.sh      # a simulated drone, its fusion, and the relay
//   sonopose_px4_side                # in another terminal
//
// With a real PX4 and its Micro-XRCE-DDS agent, `sonopose-ros2 --px4 /` needs neither.

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/data_writer.hpp>
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/names.hpp>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
  using namespace sonopose;
  using namespace std::chrono;
  const long max_messages = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 0;

  const dds::DomainParticipant participant;
  const dds::Topic<ros2::TimesyncStatus> clock_topic(participant,
                                                     ros2::name_in_dds("/fmu/out/timesync_status"));
  const dds::Topic<ros2::VehicleOdometry> odometry_topic(
      participant, ros2::name_in_dds("/fmu/in/vehicle_visual_odometry"));
  // The QoS of PX4's client.
  dds::Qos qos;
  qos << dds::policy::Reliability::best_effort() << dds::policy::History::keep_last(5);
  dds::DataWriter<ros2::TimesyncStatus> clock(participant, clock_topic, qos);
  dds::DataReader<ros2::VehicleOdometry> reader(participant, odometry_topic, qos);
  const dds::ReadCondition has_data(reader);
  dds::WaitSet waitset;
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
    waitset.wait(milliseconds(20));
    for (const auto sample : reader.take()) {
      if (!sample.info().valid()) continue;
      const ros2::VehicleOdometry& odometry = sample.data();
      std::cout << (odometry.pose_frame == 1 ? "NED " : "FRD ") << odometry.position[0] << ' '
                << odometry.position[1] << ' ' << odometry.position[2] << " m, quality "
                << int{odometry.quality} << " %, resets " << int{odometry.reset_counter} << std::endl;
      ++seen;
    }
  }
}
