/// References to entities of the PSM.

#include "platform/dds/psm/psm_fixture.hpp"

#include <catch2/catch.hpp>

namespace psm_entities_test {

using namespace psm_fixture;

SCENARIO("copies refer to one entity, which ends with the last of them") {
  Bus bus;
  const auto matched = [&bus] { return bus.writer.publication_matched_status().current_count(); };

  GIVEN("two references to a second reader") {
    dds::sub::DataReader<Sample> first(bus.subscriber, bus.topic, reliable_reader());
    dds::sub::DataReader<Sample> second = first;
    REQUIRE(wait_until([&] { return matched() == 2; }));
    CHECK((first == second));
    CHECK((first != bus.reader));
    CHECK((first.instance_handle() == second.instance_handle()));

    WHEN("one of them becomes null") {
      first = dds::core::null;
      THEN("the reader goes on") {
        CHECK((first == dds::core::null));
        CHECK(first.is_nil());
        CHECK((second != dds::core::null));
        bus.writer.write(sample(1));
        CHECK((second.take().length() == 1));
        CHECK_THROWS_AS(first.take(), dds::core::NullReferenceError);
      }
    }
    WHEN("both become null") {
      first = dds::core::null;
      second = dds::core::null;
      THEN("the reader is gone") {
        CHECK(wait_until([&] { return matched() == 1; }));
      }
    }
    WHEN("it is closed") {
      first.close();
      THEN("both are closed, and not null") {
        CHECK((second != dds::core::null));
        CHECK_THROWS_AS(second.take(), dds::core::AlreadyClosedError);
      }
    }
  }
}

SCENARIO("entities know what they belong to") {
  Bus bus;
  CHECK((bus.participant.domain_id() == domain_id()));
  CHECK((bus.reader.subscriber() == bus.subscriber));
  CHECK((bus.writer.publisher() == bus.publisher));
  CHECK((bus.writer.topic() == bus.topic));
  CHECK((bus.subscriber.participant() == bus.participant));
  CHECK((bus.publisher.participant() == bus.participant));
  CHECK((bus.topic.name() == "psm"));
  CHECK((bus.topic.type_name() == "psm_test::Sample"));
  CHECK((bus.participant.default_topic_qos() == dds::topic::qos::TopicQos()));
  CHECK((dds::topic::topic_type_name<Sample>::value() == "psm_test::Sample"));
  const dds::core::Entity entity = bus.reader;
  CHECK((entity == bus.reader));
}

SCENARIO("a writer keeps its publisher and topic") {
  Bus bus;
  bus.publisher = dds::core::null;
  bus.topic = dds::core::null;
  bus.participant = dds::core::null;
  bus.writer.write(sample(3));
  CHECK((bus.reader.take().length() == 1));
}

SCENARIO("a topic closes after its readers and writers") {
  Bus bus;
  CHECK_THROWS_AS(bus.topic.close(), dds::core::PreconditionNotMetError);
  bus.reader.close();
  CHECK_THROWS_AS(bus.topic.close(), dds::core::PreconditionNotMetError);
  bus.writer.close();
  bus.topic.close();
  CHECK_THROWS_AS(bus.topic.instance_handle(), dds::core::AlreadyClosedError);
}

SCENARIO("what Cyclone DDS refuses is an exception") {
  Bus bus;
  CHECK_THROWS_AS(dds::topic::Topic<Sample>(bus.participant, "not a name"), dds::core::Exception);
  CHECK_THROWS_AS(bus.writer.dispose_instance(dds::core::InstanceHandle::nil()), dds::core::Exception);
}

SCENARIO("durations and times are seconds and nanoseconds") {
  using dds::core::Duration;
  using dds::core::Time;
  CHECK((Duration::from_millisecs(1500) == Duration(1, 500'000'000)));
  CHECK((Duration(1, 600'000'000) + Duration(0, 600'000'000) == Duration(2, 200'000'000)));
  CHECK((Duration(2, 0) - Duration(0, 1) == Duration(1, 999'999'999)));
  CHECK((Duration(2, 0) < Duration::infinite()));
  CHECK(Duration(2, 345'000'000).to_secs() == Approx(2.345));
  CHECK((Time(5, 0) - Duration(1, 0) == Time(4, 0)));
  CHECK((Time(5, 1).to_microsecs() == 5'000'000));
  CHECK_THROWS_AS(Duration(-1, 0), dds::core::Error);
  CHECK_THROWS_AS(Time(-1, 0), dds::core::Error);
  CHECK((Time::invalid() < Time(0, 0)));
  CHECK_THROWS_AS(Duration(0, 1'000'000'000), dds::core::Error);
  CHECK_THROWS_AS(Duration::infinite().to_millisecs(), dds::core::IllegalOperationError);
}

}  // namespace psm_entities_test
