// A consumer in Cyclone DDS's own C++ binding: prints where every beacon on the bus is. The domain is
// ROS_DOMAIN_ID; without it, the one that CYCLONEDDS_URI names, otherwise 0. CYCLONEDDS_URI must name the
// loopback configuration (README, "Add a consumer").

#include "sonopose.hpp"

#include <dds/dds.hpp>

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

namespace {

std::uint32_t domain_id() {
  const char* const text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return org::eclipse::cyclonedds::domain::default_id();
  return static_cast<std::uint32_t>(std::stoul(text));
}

}  // namespace

int main() try {
  const dds::domain::DomainParticipant participant(domain_id());
  const dds::topic::Topic<sonopose::FusedPose> topic(participant, "sonopose/pose");
  const dds::sub::Subscriber subscriber(participant);

  // Exclusive, as the pose's writers are: a second fusion may stand by for the first one.
  dds::sub::qos::DataReaderQos qos = subscriber.default_datareader_qos();
  qos << dds::core::policy::Reliability::Reliable(dds::core::Duration::from_millisecs(100))
      << dds::core::policy::History::KeepLast(32) << dds::core::policy::Ownership::Exclusive();
  dds::sub::DataReader<sonopose::FusedPose> reader(subscriber, topic, qos);

  dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;
  while (true) {
    waitset.wait(dds::core::Duration::infinite());
    for (const auto& sample : reader.take()) {
      if (!sample.info().valid()) continue;
      const sonopose::FusedPose& pose = sample.data();
      std::cout << pose.address() << ": " << pose.position().x() << ' ' << pose.position().y() << ' '
                << pose.position().z() << '\n';
    }
  }
} catch (const dds::core::Exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
