#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <stdexcept>

namespace sonopose::dds::test::qos_test {

using std::chrono::milliseconds;

TEST_CASE("A QoS returns the policies that were set, and no others") {
  Qos qos;
  CHECK_FALSE(qos.policy<policy::Deadline>());
  CHECK_FALSE(qos.policy<policy::History>());
  qos << policy::Deadline{milliseconds(7)} << policy::LatencyBudget{milliseconds(8)}
      << policy::Lifespan{milliseconds(9)} << policy::Reliability::reliable(milliseconds(10))
      << policy::History::keep_last(11) << policy::Durability{policy::DurabilityKind::transient_local}
      << policy::Liveliness{policy::LivelinessKind::manual_by_participant, milliseconds(12)}
      << policy::Ownership{policy::OwnershipKind::exclusive} << policy::OwnershipStrength{-13}
      << policy::ResourceLimits{14, 15, policy::length_unlimited} << policy::TransportPriority{16}
      << policy::Partition{{"a", "b*"}} << policy::UserData{{0, 17, 255}};
  const Qos copy = qos;
  qos << policy::Deadline{infinite};

  CHECK(qos.policy<policy::Deadline>()->period == infinite);
  CHECK(copy.policy<policy::Deadline>()->period == milliseconds(7));
  CHECK(copy.policy<policy::LatencyBudget>()->duration == milliseconds(8));
  CHECK(copy.policy<policy::Lifespan>()->duration == milliseconds(9));
  CHECK(copy.policy<policy::Reliability>()->kind == policy::ReliabilityKind::reliable);
  CHECK(copy.policy<policy::Reliability>()->max_blocking_time == milliseconds(10));
  CHECK(copy.policy<policy::History>()->kind == policy::HistoryKind::keep_last);
  CHECK(copy.policy<policy::History>()->depth == 11);
  CHECK(copy.policy<policy::Durability>()->kind == policy::DurabilityKind::transient_local);
  CHECK(copy.policy<policy::Liveliness>()->kind == policy::LivelinessKind::manual_by_participant);
  CHECK(copy.policy<policy::Liveliness>()->lease_duration == milliseconds(12));
  CHECK(copy.policy<policy::Ownership>()->kind == policy::OwnershipKind::exclusive);
  CHECK(copy.policy<policy::OwnershipStrength>()->value == -13);
  CHECK(copy.policy<policy::ResourceLimits>()->max_samples == 14);
  CHECK(copy.policy<policy::ResourceLimits>()->max_instances == 15);
  CHECK(copy.policy<policy::ResourceLimits>()->max_samples_per_instance == policy::length_unlimited);
  CHECK(copy.policy<policy::TransportPriority>()->value == 16);
  CHECK(copy.policy<policy::Partition>()->names == std::vector<std::string>{"a", "b*"});
  CHECK(copy.policy<policy::UserData>()->value == std::vector<std::uint8_t>{0, 17, 255});
}

TEST_CASE("Merging takes the policies that the other sets and keeps the rest") {
  Qos base = Qos() << policy::Deadline{milliseconds(1)} << policy::History::keep_last(2);
  base.merge(Qos() << policy::History::keep_all() << policy::TransportPriority{3});
  CHECK(base.policy<policy::Deadline>()->period == milliseconds(1));
  CHECK(base.policy<policy::History>()->kind == policy::HistoryKind::keep_all);
  CHECK(base.policy<policy::TransportPriority>()->value == 3);
}

TEST_CASE("Invalid values are rejected") {
  Qos qos;
  CHECK_THROWS_AS(qos << policy::Deadline{Duration::zero()}, std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::Deadline{milliseconds(-1)}, std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::LatencyBudget{milliseconds(-1)}, std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::Lifespan{Duration::zero()}, std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::Reliability::reliable(milliseconds(-1)), std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::History::keep_last(0), std::invalid_argument);
  const policy::Liveliness no_lease{policy::LivelinessKind::automatic, Duration::zero()};
  CHECK_THROWS_AS(qos << no_lease, std::invalid_argument);
  const policy::ResourceLimits no_samples{0, 1, 1};
  CHECK_THROWS_AS(qos << no_samples, std::invalid_argument);
  CHECK_FALSE(qos.policy<policy::Deadline>());
}

TEST_CASE("Writer and reader match only in a common partition") {
  using Command = sonopose_ResetCommand;
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/partition");
  const auto in = [](const char* name) {
    return Qos() << policy::Reliability::reliable() << policy::Partition{{name}};
  };
  DataReader<Command> reader(member, topic, in("left"));
  const DataWriter<Command> other(member, topic, in("right"));
  const DataWriter<Command> same(member, topic, in("left"));
  REQUIRE(matched(reader));
  CHECK(reader.matched_publications() == std::vector<InstanceHandle>{same.instance_handle()});
}

}  // namespace sonopose::dds::test::qos_test
