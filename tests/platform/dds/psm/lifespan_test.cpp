#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdio>
#include <malloc.h>
#include <memory>
#include <thread>

namespace sonopose::dds::test::lifespan_test {

constexpr std::uint16_t busy_beacon = 1;
constexpr std::uint16_t first_gone = 2;
constexpr int gone_beacons = 30;

/// A reader of poses in another process, which ends with this object.
using OtherProcess = std::unique_ptr<FILE, int (*)(FILE*)>;

OtherProcess reader_elsewhere() {
  const std::string command =
      std::string(SONOPOSE_TEST_DDS_PEER) + " " + std::to_string(test_domain()) + " loopback poses";
  return {popen(command.c_str(), "w"), pclose};
}

double allocated_mb() {
  return static_cast<double>(mallinfo2().uordblks) / (1 << 20);
}

/// A writer that never pauses does not request acknowledgements from its readers (docs/reliability.md,
/// "Soak").
TEST_CASE("A busy writer does not keep the samples of beacons that are gone") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<sonopose_FusedPose> topic(member, topics::pose.name);
  constexpr std::chrono::seconds lifespan(3);  // shorter than the project's
  Qos qos = project_qos().datawriter_qos(topics::pose.profile);
  qos << policy::Lifespan(ext::to_duration(lifespan));
  pub::DataWriter<sonopose_FusedPose> writer(pub::Publisher(member), topic, qos);
  const OtherProcess reader = reader_elsewhere();
  REQUIRE(reader != nullptr);
  REQUIRE(wait_for(writer, core::status::StatusMask::publication_matched(),
                   [&] { return writer.publication_matched_status().current_count() == 1; }));
  const auto pose_of = [](std::uint16_t address) {
    sonopose_FusedPose pose{};
    pose.address = address;
    return pose;
  };
  const auto stay_busy = [&] {
    writer.write(pose_of(busy_beacon));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  const double before_mb = allocated_mb();
  double with_beacons_mb =
      0;  // maximum, since on a busy machine the first samples may expire before the last
  constexpr double unacknowledged_mb = 0.3;
  // Again if a pause by a busy machine had them acknowledged.
  for (int i = 0; i < 10 && with_beacons_mb <= unacknowledged_mb; ++i) {
    for (std::uint16_t address = first_gone; address < first_gone + gone_beacons; ++address) {
      for (int k = 0; k < 64; ++k) writer.write(pose_of(address));
      writer.unregister_instance(pose_of(address));
      stay_busy();
      with_beacons_mb = std::max(with_beacons_mb, allocated_mb() - before_mb);
    }
  }
  if (with_beacons_mb == 0) {
    WARN("skipped: the sanitizer's memory is not measured");
    return;
  }
  REQUIRE(with_beacons_mb > unacknowledged_mb);  // nothing was acknowledged without a pause
  const auto give_up = std::chrono::steady_clock::now() + test_timeout;
  while (allocated_mb() - before_mb > 0.25 * with_beacons_mb && std::chrono::steady_clock::now() < give_up) {
    stay_busy();
  }
  CHECK(allocated_mb() - before_mb <= 0.25 * with_beacons_mb);
}

}  // namespace sonopose::dds::test::lifespan_test
