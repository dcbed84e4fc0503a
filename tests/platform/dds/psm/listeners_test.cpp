/// Listeners of the PSM.

#include "platform/dds/psm/psm_fixture.hpp"

#include <catch2/catch.hpp>

#include <atomic>

namespace psm_listeners_test {

using namespace psm_fixture;
using dds::core::status::StatusMask;

class ReaderListener : public dds::sub::NoOpDataReaderListener<Sample> {
public:
  void on_data_available(dds::sub::DataReader<Sample>& reader) override {
    for (const auto& each : reader.take()) {
      if (each.info().valid()) last_id = each.data().id();
    }
  }
  void on_subscription_matched(dds::sub::DataReader<Sample>& reader,
                               const dds::core::status::SubscriptionMatchedStatus& status) override {
    topic_is_known = reader.topic_description().name() == "listened";
    matched = status.current_count();
  }

  std::atomic<int> last_id = 0;
  std::atomic<int> matched = 0;
  std::atomic<bool> topic_is_known = false;
};

class WriterListener : public dds::pub::NoOpDataWriterListener<Sample> {
public:
  void on_publication_matched(dds::pub::DataWriter<Sample>&,
                              const dds::core::status::PublicationMatchedStatus& status) override {
    matched = status.current_count();
  }

  std::atomic<int> matched = 0;
};

SCENARIO("listeners of the PSM are called") {
  GIVEN("a writer and a reader with listeners") {
    Bus bus;
    const dds::topic::Topic<Sample> topic(bus.participant, "listened");
    WriterListener on_writer;
    ReaderListener on_reader;
    dds::pub::DataWriter<Sample> writer(bus.publisher, topic, reliable_writer(), &on_writer,
                                        StatusMask::publication_matched());
    dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader(), &on_reader,
                                        StatusMask::data_available() | StatusMask::subscription_matched());
    CHECK((reader.listener() == &on_reader));
    CHECK((writer.listener() == &on_writer));

    WHEN("they match, and a sample is written") {
      CHECK(wait_until([&] { return on_writer.matched == 1 && on_reader.matched == 1; }));
      writer.write(sample(9));
      THEN("the reader's listener receives it") {
        CHECK(wait_until([&] { return on_reader.last_id == 9; }));
        CHECK(on_reader.topic_is_known);
      }
    }
    WHEN("the listener is removed") {
      reader.listener(nullptr, StatusMask::none());
      writer.write(sample(9));
      THEN("the sample stays in the reader") {
        CHECK(wait_until([&] { return reader.read().length() == 1; }));
        CHECK((on_reader.last_id == 0));
        CHECK((reader.listener() == nullptr));
      }
    }
    writer.listener(nullptr, StatusMask::none());
    reader.listener(nullptr, StatusMask::none());
  }
}

/// Keeps what it is called with.
class KeepingListener : public dds::sub::NoOpDataReaderListener<Sample> {
public:
  void on_data_available(dds::sub::DataReader<Sample>& reader) override {
    kept = reader;
    condition = dds::sub::cond::ReadCondition(reader, dds::sub::status::DataState::any());
    status = dds::core::cond::StatusCondition(reader);
    called = true;
  }

  dds::sub::DataReader<Sample> kept = dds::core::null;
  dds::sub::cond::ReadCondition condition = dds::core::null;
  dds::core::cond::StatusCondition status = dds::core::null;
  std::atomic<bool> called = false;
};

SCENARIO("a reader that a callback kept lives on") {
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "kept");
  KeepingListener listener;
  dds::pub::DataWriter<Sample> writer(bus.publisher, topic, reliable_writer());
  {
    dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader(), &listener,
                                        StatusMask::data_available());
    writer.write(sample(4));
    REQUIRE(wait_until([&] { return listener.called.load(); }));
    reader.listener(nullptr, StatusMask::none());
  }
  CHECK(listener.condition.trigger_value());
  CHECK((dds::core::cond::StatusCondition(listener.kept) == listener.status));
  REQUIRE((listener.kept.take().length() == 1));
  CHECK_FALSE(listener.condition.trigger_value());
}

}  // namespace psm_listeners_test
