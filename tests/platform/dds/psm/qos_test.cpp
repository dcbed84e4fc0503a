/// QoS of the PSM.

#include "platform/dds/psm/psm_fixture.hpp"

#include <catch2/catch.hpp>

namespace psm_qos_test {

using namespace psm_fixture;
using namespace dds::core::policy;
using dds::core::Duration;

SCENARIO("policies return what was set") {
  dds::pub::qos::DataWriterQos qos;
  CHECK((qos.policy<Reliability>().kind() == ReliabilityKind::RELIABLE));
  CHECK((dds::sub::qos::DataReaderQos().policy<Reliability>().kind() == ReliabilityKind::BEST_EFFORT));
  CHECK((qos.policy<History>() == History::KeepLast(1)));

  qos << Reliability::Reliable(Duration(3, 0)) << History::KeepAll() << Ownership::Exclusive()
      << OwnershipStrength(7) << Durability::TransientLocal() << Deadline(Duration(0, 5))
      << Liveliness::ManualByTopic(Duration(9, 0)) << Lifespan(Duration(4, 0))
      << LatencyBudget(Duration(0, 6)) << UserData(dds::core::ByteSeq{1, 2}) << ResourceLimits(10, 2, 5)
      << TransportPriority(3) << WriterDataLifecycle::ManuallyDisposeUnregisteredInstances();
  CHECK((qos.policy<Reliability>().max_blocking_time() == Duration(3, 0)));
  CHECK((qos.policy<History>().kind() == HistoryKind::KEEP_ALL));
  CHECK((qos.policy<Ownership>().kind() == OwnershipKind::EXCLUSIVE));
  CHECK((qos.policy<OwnershipStrength>().value() == 7));
  CHECK((qos.policy<Durability>().kind() == DurabilityKind::TRANSIENT_LOCAL));
  CHECK((qos.policy<Deadline>().period() == Duration(0, 5)));
  CHECK((qos.policy<Liveliness>() == Liveliness(LivelinessKind::MANUAL_BY_TOPIC, Duration(9, 0))));
  CHECK((qos.policy<Lifespan>().duration() == Duration(4, 0)));
  CHECK((qos.policy<LatencyBudget>().duration() == Duration(0, 6)));
  CHECK((qos.policy<UserData>().value() == dds::core::ByteSeq{1, 2}));
  CHECK((qos.policy<ResourceLimits>().max_instances() == 2));
  CHECK((qos.policy<TransportPriority>().value() == 3));
  CHECK_FALSE(qos.policy<WriterDataLifecycle>().autodispose_unregistered_instances());
  qos.policy<OwnershipStrength>().value(8);
  OwnershipStrength strength;
  qos >> strength;
  CHECK((strength.value() == 8));

  AND_THEN("an entity has them, and its copies are equal") {
    Bus bus;
    const dds::pub::DataWriter<Sample> writer(bus.publisher, bus.topic, qos);
    CHECK((writer.qos() == qos));
    CHECK((writer.qos() != bus.writer.qos()));
  }
}

SCENARIO("what a topic and a reader have in common can be copied") {
  dds::topic::qos::TopicQos topic;
  topic << Durability::TransientLocal() << Reliability::Reliable();
  const dds::sub::qos::DataReaderQos reader(topic);
  CHECK((reader.policy<Durability>().kind() == DurabilityKind::TRANSIENT_LOCAL));
  CHECK((reader.policy<Reliability>().kind() == ReliabilityKind::RELIABLE));
}

SCENARIO("invalid policies are refused") {
  dds::pub::qos::DataWriterQos qos;
  CHECK_THROWS_AS(qos << History(HistoryKind::KEEP_LAST, 0), dds::core::InconsistentPolicyError);
  CHECK_THROWS_AS(qos << ResourceLimits(0), dds::core::InvalidArgumentError);
  CHECK((qos == dds::pub::qos::DataWriterQos()));
}

SCENARIO("an existing writer changes what can change") {
  Bus bus;
  auto qos = bus.writer.qos();
  bus.writer.qos(qos << OwnershipStrength(3));
  CHECK((bus.writer.qos().policy<OwnershipStrength>().value() == 3));
  CHECK_THROWS_AS(bus.writer.qos(qos << Durability::TransientLocal()), dds::core::ImmutablePolicyError);
}

SCENARIO("endpoints with incompatible QoS say so") {
  GIVEN("a best-effort writer") {
    Bus bus;
    const dds::topic::Topic<Sample> topic(bus.participant, "incompatible");
    dds::pub::DataWriter<Sample> writer(bus.publisher, topic,
                                        dds::pub::qos::DataWriterQos() << Reliability::BestEffort());
    WHEN("a reader requests reliability") {
      dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader());
      THEN("both name the policy") {
        CHECK(wait_until([&] { return reader.requested_incompatible_qos_status().total_count() == 1; }));
        CHECK((reader.requested_incompatible_qos_status().last_policy_id() == policy_id<Reliability>::value));
        CHECK(wait_until([&] { return writer.offered_incompatible_qos_status().total_count() == 1; }));
        CHECK((writer.offered_incompatible_qos_status().last_policy_id() == policy_id<Reliability>::value));
      }
    }
  }
}

SCENARIO("endpoints match only within a partition") {
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "partitions");
  const dds::pub::Publisher north(bus.participant, dds::pub::qos::PublisherQos() << Partition("north"));
  const dds::sub::Subscriber both(bus.participant, dds::sub::qos::SubscriberQos()
                                                       << Partition(dds::core::StringSeq{"north", "south"}));
  CHECK((both.qos().policy<Partition>().name() == dds::core::StringSeq{"north", "south"}));
  dds::pub::DataWriter<Sample> writer(north, topic, reliable_writer());
  dds::sub::DataReader<Sample> outside(bus.subscriber, topic, reliable_reader());
  dds::sub::DataReader<Sample> inside(both, topic, reliable_reader());
  CHECK(wait_until([&] { return writer.publication_matched_status().current_count() == 1; }));
  writer.write(sample(1));
  CHECK((inside.take().length() == 1));
  CHECK((outside.take().length() == 0));
}

SCENARIO("the stronger of two exclusive writers is received") {
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "owned");
  dds::pub::DataWriter<Sample> weak(bus.publisher, topic,
                                    reliable_writer() << Ownership::Exclusive() << OwnershipStrength(1));
  dds::pub::DataWriter<Sample> strong(bus.publisher, topic,
                                      reliable_writer() << Ownership::Exclusive() << OwnershipStrength(2));
  dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader() << Ownership::Exclusive());
  REQUIRE(wait_until([&] { return reader.subscription_matched_status().current_count() == 2; }));
  strong.write(sample(1, "strong"));
  weak.write(sample(1, "weak"));
  CHECK((codes(reader.take()) == Codes{"strong"}));
}

}  // namespace psm_qos_test
