// A consumer in Cyclone DDS's own C++ binding: prints where every beacon on the bus is.

#include "sonopose.hpp"

#include <dds/dds.hpp>

#include <iostream>

int main() try {
  const dds::domain::DomainParticipant participant(org::eclipse::cyclonedds::domain::default_id());
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
