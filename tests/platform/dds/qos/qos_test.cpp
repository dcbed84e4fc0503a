#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <limits>
#include <stdexcept>

namespace sonopose::dds::test::qos_test {

using std::chrono::milliseconds;

TEST_CASE("A QoS returns the policies that were set, and no others") {
  Qos qos;
  CHECK_FALSE(qos.policy<policy::Deadline>());
  CHECK_FALSE(qos.policy<policy::History>());
  qos << policy::Deadline(ext::to_duration(milliseconds(7)))
      << policy::LatencyBudget(ext::to_duration(milliseconds(8)))
      << policy::Lifespan(ext::to_duration(milliseconds(9)))
      << policy::Reliability::Reliable(ext::to_duration(milliseconds(10))) << policy::History::KeepLast(11)
      << policy::Durability::TransientLocal()
      << policy::Liveliness(policy::LivelinessKind::MANUAL_BY_PARTICIPANT, ext::to_duration(milliseconds(12)))
      << policy::Ownership::Exclusive() << policy::OwnershipStrength(-13)
      << policy::ResourceLimits(14, 15, core::LENGTH_UNLIMITED) << policy::TransportPriority(16)
      << policy::Partition(core::StringSeq{"a", "b*"}) << policy::UserData({0, 17, 255});
  const Qos copy = qos;
  qos << policy::Deadline();

  CHECK(qos.policy<policy::Deadline>()->period() == core::Duration::infinite());
  CHECK(copy.policy<policy::Deadline>()->period() == core::Duration::from_millisecs(7));
  CHECK(copy.policy<policy::LatencyBudget>()->duration() == core::Duration::from_millisecs(8));
  CHECK(copy.policy<policy::Lifespan>()->duration() == core::Duration::from_millisecs(9));
  CHECK(copy.policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
  CHECK(copy.policy<policy::Reliability>()->max_blocking_time() == core::Duration::from_millisecs(10));
  CHECK(copy.policy<policy::History>()->kind() == policy::HistoryKind::KEEP_LAST);
  CHECK(copy.policy<policy::History>()->depth() == 11);
  CHECK(copy.policy<policy::Durability>()->kind() == policy::DurabilityKind::TRANSIENT_LOCAL);
  CHECK(copy.policy<policy::Liveliness>()->kind() == policy::LivelinessKind::MANUAL_BY_PARTICIPANT);
  CHECK(copy.policy<policy::Liveliness>()->lease_duration() == core::Duration::from_millisecs(12));
  CHECK(copy.policy<policy::Ownership>()->kind() == policy::OwnershipKind::EXCLUSIVE);
  CHECK(copy.policy<policy::OwnershipStrength>()->value() == -13);
  CHECK(copy.policy<policy::ResourceLimits>()->max_samples() == 14);
  CHECK(copy.policy<policy::ResourceLimits>()->max_instances() == 15);
  CHECK(copy.policy<policy::ResourceLimits>()->max_samples_per_instance() == core::LENGTH_UNLIMITED);
  CHECK(copy.policy<policy::TransportPriority>()->value() == 16);
  CHECK(copy.policy<policy::Partition>()->name() == std::vector<std::string>{"a", "b*"});
  CHECK(copy.policy<policy::UserData>()->value() == std::vector<std::uint8_t>{0, 17, 255});
}

TEST_CASE("Merging takes the policies that the other sets and keeps the rest") {
  Qos base = Qos() << policy::Deadline(ext::to_duration(milliseconds(1))) << policy::History::KeepLast(2);
  base.merge(Qos() << policy::History::KeepAll() << policy::TransportPriority(3));
  CHECK(base.policy<policy::Deadline>()->period() == core::Duration::from_millisecs(1));
  CHECK(base.policy<policy::History>()->kind() == policy::HistoryKind::KEEP_ALL);
  CHECK(base.policy<policy::TransportPriority>()->value() == 3);
}

TEST_CASE("Invalid values are rejected") {
  Qos qos;
  CHECK_THROWS_AS(qos << policy::Deadline(core::Duration::zero()), std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::Lifespan(core::Duration::zero()), std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::History::KeepLast(0), core::InconsistentPolicyError);
  CHECK_THROWS_AS(qos << policy::Liveliness::Automatic(core::Duration::zero()), std::invalid_argument);
  CHECK_THROWS_AS(qos << policy::ResourceLimits(0, 1, 1), std::invalid_argument);
  CHECK_FALSE(qos.policy<policy::Deadline>());
}

TEST_CASE("Negative durations in a QoS of others are read as zero") {
  Qos qos;
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, std::numeric_limits<std::int64_t>::min());
  CHECK(qos.policy<policy::Reliability>() == policy::Reliability::Reliable(core::Duration::zero()));
}

TEST_CASE("Writer and reader match only in a common partition") {
  using Command = sonopose_ResetCommand;
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/partition");
  const auto in = [](const char* name) {
    return Qos() << policy::Reliability::Reliable() << policy::Partition(name);
  };
  sub::DataReader<Command> reader(ext::subscriber_of(member, in("left")), topic, in("left"));
  const pub::DataWriter<Command> other(ext::publisher_of(member, in("right")), topic, in("right"));
  const pub::DataWriter<Command> same(ext::publisher_of(member, in("left")), topic, in("left"));
  REQUIRE(matched(reader));
  CHECK(ext::matched_publications(reader) == std::vector<core::InstanceHandle>{same.instance_handle()});
}

}  // namespace sonopose::dds::test::qos_test
