// A consumer of its own: prints where every beacon on the bus is. Ends after as many poses as its argument
// says. It compiles unchanged with cyclonedds-cxx (CMakeLists.txt).

#include "sonopose.hpp"

#include <dds/dds.hpp>

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

namespace {

/// ROS_DOMAIN_ID, as for the programs of sonopose.
std::uint32_t domain_id() {
  const char* const text = std::getenv("ROS_DOMAIN_ID");
  return text == nullptr || *text == '\0' ? 0 : static_cast<std::uint32_t>(std::stoul(text));
}

}  // namespace

int main(int argc, char** argv) try {
  const long max_poses = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 0;

  dds::domain::DomainParticipant participant(domain_id());
  dds::topic::Topic<sonopose::FusedPose> topic(participant, "sonopose/pose");
  dds::sub::Subscriber subscriber(participant);

  // Exclusive, as the pose's writers are: a second fusion may stand by for the first one.
  dds::sub::qos::DataReaderQos qos = subscriber.default_datareader_qos();
  qos << dds::core::policy::Reliability::Reliable() << dds::core::policy::History::KeepLast(32)
      << dds::core::policy::Ownership::Exclusive();
  dds::sub::DataReader<sonopose::FusedPose> reader(subscriber, topic, qos);

  dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;

  for (long seen = 0; max_poses == 0 || seen < max_poses;) {
    waitset.wait();
    for (const auto& sample : reader.take()) {
      if (!sample.info().valid()) continue;
      const sonopose::FusedPose& pose = sample.data();
      std::cout << pose.address() << ": " << pose.position().x() << ' ' << pose.position().y() << ' '
                << pose.position().z() << '\n';
      ++seen;
    }
  }
} catch (const dds::core::Exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
