/// A consumer that pins a fusion.

#include "dds/dds_fixture.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/topics/pinned_fusion.hpp>

#include <catch2/catch.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::dds::test::pinned_fusion_test {

using sonopose::test::wait_until;

/// A process that writes poses and statuses of beacon 7.
struct Fusion {
  Fusion(std::uint64_t id, std::int32_t strength) {
    poses.qos(poses.qos() << policy::OwnershipStrength(strength));
    sonopose_FusionStatus status{};
    status.address = 7;
    status.fusion_id = id;
    statuses.write(status);
  }

  domain::DomainParticipant member = participant();
  pub::DataWriter<sonopose_FusedPose> poses = topics::make_writer(member, project_qos(), topics::pose);
  pub::DataWriter<sonopose_FusionStatus> statuses =
      topics::make_writer(member, project_qos(), topics::fusion_status);
};

/// A consumer that pins fusion 42.
struct Consumer {
  /// Writes poses until the consumer receives one of them. Returns true if it is of the pinned fusion; empty
  /// if none arrives.
  std::optional<bool> verdict_on(Fusion& fusion) {
    std::optional<bool> verdict;
    const std::uint64_t sequence = ++next_sequence;
    wait_until([&] {
      sonopose_FusedPose pose{};
      pose.address = 7;
      pose.event_sequence = sequence;
      fusion.poses.write(pose);
      ext::take_each(poses, [&](const sonopose_FusedPose& received, const sub::SampleInfo& info) {
        if (received.event_sequence == sequence) verdict = pin.wrote(poses, info);
      });
      return verdict.has_value();
    });
    return verdict;
  }

  domain::DomainParticipant member = participant();
  sub::DataReader<sonopose_FusedPose> poses = topics::make_reader(member, project_qos(), topics::pose);
  topics::PinnedFusion pin{member, project_qos(), 42};
  std::uint64_t next_sequence = 0;
};

SCENARIO("a pinned fusion's poses are told from others") {
  GIVEN("a fusion, and a consumer that pins it") {
    Consumer consumer;
    std::optional<Fusion> fusion(std::in_place, 42, 100);
    REQUIRE(wait_until([&] { return consumer.verdict_on(*fusion) == true; }));
    WHEN("a stronger process takes the beacon over, with the same id in its statuses") {
      Fusion stranger(42, 1000);
      THEN("its poses are not accepted") {
        for (int i = 0; i < 20; ++i) CHECK(consumer.verdict_on(stranger) == false);
        AND_WHEN("it ends") {
          stranger.poses.close();
          THEN("those of the fusion are again") {
            CHECK(consumer.verdict_on(*fusion) == true);
          }
        }
      }
    }
    WHEN("the fusion ends, and another begins with another id") {
      fusion.reset();
      Fusion next(43, 100);
      THEN("its poses are not accepted") {
        CHECK(consumer.verdict_on(next) == false);
      }
    }
  }
}

}  // namespace sonopose::dds::test::pinned_fusion_test
