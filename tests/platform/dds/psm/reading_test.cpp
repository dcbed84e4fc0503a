/// Readers of the PSM: read, take, select, and what belongs to a sample.

#include "platform/dds/psm/psm_fixture.hpp"

#include <catch2/catch.hpp>

namespace psm_reading_test {

using namespace psm_fixture;
using dds::sub::status::DataState;
using dds::sub::status::InstanceState;
using dds::sub::status::SampleState;
using dds::sub::status::ViewState;

SCENARIO("a reader of the PSM reads and takes samples") {
  GIVEN("two samples of one instance and one of another") {
    Bus bus;
    bus.writer.write(sample(1, "a"), dds::core::Time(7, 8));
    bus.writer << sample(1, "b") << sample(2, "c");

    WHEN("they are read and then taken") {
      const auto read = bus.reader.read();
      const auto again = bus.reader.select().state(SampleState::not_read()).read();
      const auto taken = bus.reader.take();
      THEN("reading leaves them, marked as read, and taking does not") {
        CHECK((codes(read) == Codes{"a", "b", "c"}));
        CHECK((read.begin()->info().timestamp() == dds::core::Time(7, 8)));
        CHECK((read.begin()->info().state() ==
               DataState(SampleState::not_read(), ViewState::new_view(), InstanceState::alive())));
        CHECK((read.begin()->info().publication_handle() == bus.writer.instance_handle()));
        CHECK((again.length() == 0));
        CHECK((codes(taken) == Codes{"a", "b", "c"}));
        CHECK((taken.begin()->info().state().sample_state() == SampleState::read()));
        CHECK((bus.reader.take().length() == 0));
      }
    }
    WHEN("an instance or a number of samples is selected") {
      const auto second = bus.reader.lookup_instance(sample(2));
      THEN("nothing else is taken") {
        CHECK((codes(bus.reader.select().instance(second).read()) == Codes{"c"}));
        CHECK((codes(bus.reader.select().max_samples(2).take()) == Codes{"a", "b"}));
        CHECK((codes(bus.reader.select().instance(second).take()) == Codes{"c"}));
        CHECK(bus.reader.lookup_instance(sample(3)).is_nil());
      }
    }
    WHEN("the reader filters by state") {
      bus.writer.dispose_instance(sample(2));
      bus.reader.default_filter_state(DataState(InstanceState::not_alive_disposed()));
      const auto ended = bus.reader.take();
      THEN("only the end of the disposed instance comes, after its sample") {
        REQUIRE(ended.length() > 0);
        for (const auto& each : ended) {
          CHECK((each.data().id() == 2));
          CHECK((each.info().state().instance_state() == InstanceState::not_alive_disposed()));
        }
        CHECK((codes(bus.reader.select().state(DataState::any()).take()) == Codes{"a", "b"}));
      }
    }
  }
}

SCENARIO("a read that is refused leaves the reader usable") {
  Bus bus;
  bus.writer.write(sample(1, "a"));
  const auto unknown = bus.writer.instance_handle();  // of no instance
  CHECK_THROWS_AS(bus.reader.select().instance(unknown).take(), dds::core::PreconditionNotMetError);
  CHECK((bus.reader.select().max_samples(0).take().length() == 0));
  bus.writer.write(sample(1, "b"));
  CHECK((codes(bus.reader.take()) == Codes{"a", "b"}));
}

SCENARIO("a sample written with the invalid time is written now") {
  Bus bus;
  bus.writer.write(sample(1), dds::core::Time::invalid());
  const auto taken = bus.reader.take();
  REQUIRE((taken.length() == 1));
  CHECK((taken.begin()->info().timestamp() > dds::core::Time(1, 0)));
}

SCENARIO("states combine") {
  DataState state;
  state << SampleState::any() << ViewState::any() << InstanceState::any();
  const DataState copied = SampleState::any();
  CHECK((copied == DataState(InstanceState::any())));
  CHECK((copied == DataState(ViewState::any())));
}

SCENARIO("the end of an instance has its key and no data") {
  Bus bus;
  Sample key = sample(5, "x");
  key.group("north");
  bus.writer.write(key);
  CHECK((bus.reader.take().length() == 1));
  const auto instance = bus.writer.lookup_instance(key);
  bus.writer.dispose_instance(instance);
  const auto samples = bus.reader.take();
  REQUIRE((samples.length() == 1));
  CHECK_FALSE(samples.begin()->info().valid());
  CHECK((samples.begin()->data().id() == 5));
  CHECK((samples.begin()->data().group() == "north"));
  CHECK(samples.begin()->data().code().empty());
  Sample found;
  CHECK((bus.writer.key_value(found, instance).group() == "north"));
  const auto registered = bus.writer.register_instance(sample(6));
  CHECK((registered == bus.writer.lookup_instance(sample(6))));
  bus.writer.unregister_instance(sample(6));
}

SCENARIO("samples outlive their reader and the next take") {
  dds::sub::LoanedSamples<Sample> kept;
  {
    Bus bus;
    for (int i = 0; i < 12; ++i) bus.writer.write(sample(1, std::to_string(i)));
    kept = bus.reader.take();
    const dds::sub::LoanedSamples<Sample> copy = kept;
    CHECK((bus.reader.take().length() == 0));
    CHECK((copy.length() == 12));
  }
  CHECK((codes(kept) == Codes{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11"}));
}

SCENARIO("a late reader gets the history of a transient-local writer") {
  using dds::core::policy::Durability;
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "history");
  dds::pub::DataWriter<Sample> writer(bus.publisher, topic,
                                      reliable_writer() << Durability::TransientLocal());
  writer.write(sample(1, "old"));
  dds::sub::DataReader<Sample> reader(bus.subscriber, topic,
                                      reliable_reader() << Durability::TransientLocal());
  reader.wait_for_historical_data(timeout);
  CHECK((codes(reader.take()) == Codes{"old"}));
}

}  // namespace psm_reading_test
