#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

namespace sonopose::dds::test::ownership_test {

using Command = sonopose_ResetCommand;

Qos exclusive(std::int32_t strength) {
  return Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(16)
               << policy::Ownership::Exclusive() << policy::OwnershipStrength(strength);
}

TEST_CASE("Of two exclusive writers the stronger one is received, instance by instance") {
  GIVEN("a strong and a weak writer") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/ownership");
    sub::DataReader<Command> reader(sub::Subscriber(member), topic,
                                    Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(16)
                                          << policy::Ownership::Exclusive());
    pub::DataWriter<Command> strong(pub::Publisher(member), topic, exclusive(20));
    pub::DataWriter<Command> weak(pub::Publisher(member), topic, exclusive(10));
    REQUIRE(matched(reader, 2));
    const auto received = [&] {
      std::vector<std::uint64_t> ids;
      ext::take_each(
          reader, [&](const Command& sample, const sub::SampleInfo&) { ids.push_back(sample.request_id); });
      return ids;
    };
    using Ids = std::vector<std::uint64_t>;

    WHEN("both write one instance") {
      weak.write(command(7, 1));  // no stronger writer has written yet
      strong.write(command(7, 2));
      weak.write(command(7, 3));
      strong.write(command(7, 4));
      THEN("the weak one is received only until the strong one writes") {
        CHECK(received() == Ids{1, 2, 4});
      }
    }
    WHEN("the strong one writes another instance only") {
      strong.write(command(8, 1));
      weak.write(command(7, 2));
      THEN("both are received") {
        CHECK(received() == Ids{1, 2});
      }
    }
    WHEN("the strong one unregisters its instance") {
      strong.write(command(7, 1));
      weak.write(command(7, 2));
      strong.unregister_instance(command(7, 0));
      weak.write(command(7, 3));
      THEN("the weak one takes over with its next sample") {
        CHECK(received() == Ids{1, 3});
      }
    }
    WHEN("the weak one is made the stronger") {
      strong.write(command(7, 1));
      weak.qos(weak.qos() << policy::OwnershipStrength(30));
      CHECK(weak.qos().policy<policy::OwnershipStrength>().value() == 30);
      weak.write(command(7, 2));
      strong.write(command(7, 3));
      THEN("it takes over while both live") {
        CHECK(received() == Ids{1, 2});
      }
    }
  }
}

TEST_CASE("With the pose's profile a standby takes over from a hanging fusion, and not earlier") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  sub::DataReader<sonopose_FusedPose> reader = topics::make_reader(member, qos, topics::pose);
  pub::DataWriter<sonopose_FusedPose> strong = topics::make_writer(member, qos, topics::pose);
  pub::DataWriter<sonopose_FusedPose> standby = topics::make_writer(member, qos, topics::pose);
  standby.qos(standby.qos() << policy::OwnershipStrength(
                  strong.qos().policy<policy::OwnershipStrength>().value() - 1));
  REQUIRE(matched(reader, 2));
  sonopose_FusedPose pose{};
  pose.address = 7;
  const auto write_as = [&pose](pub::DataWriter<sonopose_FusedPose>& writer, std::uint64_t number) {
    pose.event_sequence = number;
    writer.write(pose);
  };
  std::vector<std::uint64_t> received;
  const auto receive = [&](std::chrono::nanoseconds timeout) {
    return wait_for(
        reader, core::status::StatusMask::data_available(),
        [&] {
          ext::take_each(reader, [&](const sonopose_FusedPose& sample, const sub::SampleInfo&) {
            received.push_back(sample.event_sequence);
          });
          return received.size() > 1;
        },
        timeout);
  };
  // The standby writes while the strong writer is alive; repeated if the machine stalled in between.
  const auto lease = ext::to_chrono(strong.qos().policy<policy::Liveliness>().lease_duration());
  auto began = std::chrono::steady_clock::now();
  do {
    receive(std::chrono::nanoseconds::zero());
    received.clear();
    ++pose.address;
    began = std::chrono::steady_clock::now();
    write_as(strong, 1);
    write_as(standby, 2);
  } while (std::chrono::steady_clock::now() - began > lease / 2);
  // The strong writer stops writing, while its process continues.
  const auto give_up = std::chrono::steady_clock::now() + test_timeout;
  std::uint64_t number = 2;
  while (!receive(std::chrono::milliseconds(10)) && std::chrono::steady_clock::now() < give_up) {
    write_as(standby, ++number);
  }
  REQUIRE(received.size() > 1);
  CHECK(received[0] == 1);
  CHECK(received[1] > 2);  // the standby's first write fell into the strong writer's life
}

}  // namespace sonopose::dds::test::ownership_test
