#include "dds/dds_fixture.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/psm/discovery.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdio>
#include <malloc.h>
#include <thread>
#include <unistd.h>

namespace sonopose::dds::test::discovery_test {

/// The endpoint on a topic, or nullptr.
const FoundEndpoint* on_topic(const std::vector<FoundEndpoint>& endpoints, const std::string& topic) {
  const auto found = std::find_if(endpoints.begin(), endpoints.end(),
                                  [&](const auto& endpoint) { return endpoint.topic_name == topic; });
  return found == endpoints.end() ? nullptr : &*found;
}

const FoundParticipant* with_key(const std::vector<FoundParticipant>& participants, const std::string& key) {
  const auto found = std::find_if(participants.begin(), participants.end(),
                                  [&](const auto& participant) { return participant.key == key; });
  return found == participants.end() ? nullptr : &*found;
}

TEST_CASE("Discovery finds this process with its readers and writers and their QoS") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  const Discovery discovery(member);
  CHECK(on_topic(discovery.writers(), topics::pose.name) == nullptr);
  auto writer = topics::make_writer(member, qos, topics::pose);
  const auto reader = topics::make_reader(member, qos, topics::imu);

  const auto writers = discovery.writers();
  const FoundEndpoint* const pose = on_topic(writers, "sonopose/pose");
  REQUIRE(pose != nullptr);
  CHECK(pose->type_name == "sonopose::FusedPose");
  CHECK(pose->participant_key == discovery.own_key());
  CHECK(pose->qos.policy<policy::Ownership>()->kind() == policy::OwnershipKind::EXCLUSIVE);
  CHECK(pose->qos.policy<policy::OwnershipStrength>()->value() == 100);

  const auto readers = discovery.readers();
  const FoundEndpoint* const imu = on_topic(readers, "sonopose/imu");
  REQUIRE(imu != nullptr);
  CHECK(imu->qos.policy<policy::Deadline>()->period() == core::Duration::from_millisecs(100));

  const auto participants = discovery.participants();
  const FoundParticipant* const own = with_key(participants, discovery.own_key());
  REQUIRE(own != nullptr);
  CHECK(own->process_id == static_cast<std::uint32_t>(getpid()));
  CHECK_THAT(own->process_name, Catch::Contains("test_dds"));
  CHECK_FALSE(own->host_name.empty());

  writer.close();
  CHECK(on_topic(discovery.writers(), "sonopose/pose") == nullptr);
}

TEST_CASE("Discovery finds another process, its writer and its identity") {
  const domain::DomainParticipant member = participant();
  const Discovery discovery(member);
  const std::string command =
      std::string(SONOPOSE_TEST_DDS_PEER) + " " + std::to_string(test_domain()) + " loopback 7";
  const auto close = [](FILE* file) { pclose(file); };
  const std::unique_ptr<FILE, decltype(close)> peer(popen(command.c_str(), "w"), close);
  REQUIRE(peer != nullptr);

  const auto give_up = std::chrono::steady_clock::now() + test_timeout;
  std::vector<FoundEndpoint> writers;
  while (on_topic(writers, "test/peer") == nullptr && std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    writers = discovery.writers();
  }
  const FoundEndpoint* const writer = on_topic(writers, "test/peer");
  REQUIRE(writer != nullptr);
  CHECK(writer->participant_key != discovery.own_key());
  CHECK(writer->qos.policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
  const auto participants = discovery.participants();
  const FoundParticipant* const process = with_key(participants, writer->participant_key);
  REQUIRE(process != nullptr);
  CHECK_THAT(process->process_name, Catch::Contains("test_dds_peer"));
  CHECK_THAT(process->addresses, Catch::Contains("127.0.0.1"));
  CHECK(process->process_id != static_cast<std::uint32_t>(getpid()));
}

/// Memory in use; 0 under a sanitizer.
std::size_t heap_bytes() {
  return mallinfo2().uordblks;
}

TEST_CASE("Discovery keeps nothing of writers that have ended") {
  // Excludes the doctors of other tests, which visit every domain and cost memory.
  const Environment tag(
      "CYCLONEDDS_URI",
      "<CycloneDDS><Domain><Discovery><Tag>discovery_test</Tag></Discovery></Domain></CycloneDDS>");
  const domain::DomainParticipant member = participant();
  const topic::Topic<sonopose_FusedPose> topic(member, topics::pose.name);
  const Discovery discovery(member);
  constexpr int times = 300;
  const auto come_and_go = [&] {
    for (int i = 0; i < times; ++i) {
      { const pub::DataWriter<sonopose_FusedPose> writer(pub::Publisher(member), topic); }
      if (i % 10 == 0) CHECK(on_topic(discovery.writers(), topics::pose.name) == nullptr);
    }
  };
  come_and_go();
  come_and_go();
  const std::size_t before = heap_bytes();
  come_and_go();
  // Cyclone DDS keeps 500 bytes of each ended writer; a sample about it in a reader takes 1,500. One of its
  // threads frees the rest some time after the writer's end.
  constexpr std::size_t max_bytes = 1'000;
  CHECK(sonopose::test::wait_until([&] { return heap_bytes() < before + times * max_bytes; }));
}

}  // namespace sonopose::dds::test::discovery_test
