// A consumer of its own: prints where every beacon on the bus is. Ends after as many poses as its argument
// says.

#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
  using namespace sonopose;
  const long max_poses = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 0;

  const dds::DomainParticipant participant;
  const dds::qos::Provider qos;
  auto reader = dds::topics::make_reader(participant, qos, dds::topics::pose);
  const dds::ReadCondition has_data(reader);
  dds::WaitSet waitset;
  waitset += has_data;

  for (long seen = 0; max_poses == 0 || seen < max_poses;) {
    waitset.wait();
    for (const auto sample : reader.take()) {
      if (!sample.info().valid()) continue;
      const FusedPose pose = dds::topics::from_idl(sample.data());
      std::cout << pose.address << ": " << pose.position_world_m.transpose() << '\n';
      ++seen;
    }
  }
}
