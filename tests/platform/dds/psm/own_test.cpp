/// Behaviour of our subset beyond the PSM, or of its own.

#include "platform/dds/psm/psm_fixture.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>

namespace psm_own_test {

using namespace psm_fixture;
using Catch::Matchers::Contains;
using dds::sub::status::DataState;
using dds::sub::status::ViewState;
namespace ext = sonopose::dds::ext;

SCENARIO("values that the wire cannot carry are refused by name") {
  Bus bus;
  Sample wrong = sample(1, "123456789");
  CHECK_THROWS_WITH(bus.writer.write(wrong), "code has 9 of at most 8 elements");
  wrong.code("");
  wrong.parts().resize(3);
  CHECK_THROWS_AS(bus.writer.write(wrong), dds::core::InvalidArgumentError);
  CHECK_THROWS_WITH(bus.writer.write(wrong), "parts has 3 of at most 2 elements");
  wrong.parts().clear();
  wrong.words({std::string("a\0b", 3)});
  CHECK_THROWS_WITH(bus.writer.write(wrong), "words contains a zero byte");
  CHECK(bus.reader.take().length() == 0);
}

SCENARIO("policies that crash or mislead Cyclone DDS are refused") {
  dds::pub::qos::DataWriterQos qos;
  using namespace dds::core::policy;
  CHECK_THROWS_AS(qos << Deadline(dds::core::Duration::zero()), dds::core::InvalidArgumentError);
  CHECK_THROWS_AS(qos << Lifespan(dds::core::Duration::zero()), dds::core::InvalidArgumentError);
  CHECK_THROWS_AS(qos << Liveliness::Automatic(dds::core::Duration::zero()), dds::core::InvalidArgumentError);
}

SCENARIO("a participant of the PSM joins like the programs") {
  GIVEN("a participant of the layer below in the same domain, on loopback") {
    const dds::domain::DomainParticipant plain(domain_id());
    THEN("options that differ are refused, since a process has one network per domain") {
      CHECK_NOTHROW(ext::participant({.domain_id = domain_id()}));
      CHECK_THROWS_AS(ext::participant({.domain_id = domain_id(), .network = sonopose::dds::Network::lan}),
                      dds::core::PreconditionNotMetError);
    }
  }
  GIVEN("a partition in the options") {
    const auto participant = ext::participant({.domain_id = domain_id(), .partition = "hall"});
    THEN("publishers and subscribers are in it") {
      CHECK(dds::pub::Publisher(participant).qos().policy<dds::core::policy::Partition>().name() ==
            dds::core::StringSeq{"hall"});
      CHECK(dds::sub::Subscriber(participant).qos().policy<dds::core::policy::Partition>().name() ==
            dds::core::StringSeq{"hall"});
    }
  }
  GIVEN("the user's choice of a domain") {
    setenv("ROS_DOMAIN_ID", std::to_string(domain_id()).c_str(), 1);
    const dds::domain::DomainParticipant participant(org::eclipse::cyclonedds::domain::default_id());
    unsetenv("ROS_DOMAIN_ID");
    THEN("it is used") {
      CHECK(participant.domain_id() == domain_id());
    }
  }
  CHECK_THROWS_AS(dds::domain::DomainParticipant(233), dds::core::InvalidArgumentError);
}

SCENARIO("closing a participant closes what belongs to it") {
  Bus bus;
  bus.participant.close();
  CHECK_THROWS_AS(bus.reader.take(), dds::core::AlreadyClosedError);
  CHECK_THROWS_AS(bus.writer.write(sample(1)), dds::core::AlreadyClosedError);
  CHECK_THROWS_AS(ext::handle(bus.topic), dds::core::AlreadyClosedError);
}

SCENARIO("what cyclonedds-cxx 0.10 lacks of the PSM is there") {
  Bus bus;
  const auto matched = [&bus] { return bus.writer.publication_matched_status().current_count(); };
  GIVEN("a closed reader with references") {
    dds::sub::DataReader<Sample> reader(bus.subscriber, bus.topic, reliable_reader());
    REQUIRE(wait_until([&] { return matched() == 2; }));
    reader.close();
    THEN("its writers no longer see it") {
      CHECK(wait_until([&] { return matched() == 1; }));
    }
  }
}

SCENARIO("a wait set without conditions waits") {
  constexpr auto timeout = std::chrono::milliseconds(50);
  const auto waits = [timeout](const dds::core::cond::WaitSet& waitset) {
    const dds_time_t begin = dds_time();
    return !ext::wait(waitset, timeout) && dds_time() - begin >= std::chrono::nanoseconds(timeout).count();
  };
  GIVEN("one to which nothing was attached") {
    CHECK(waits(dds::core::cond::WaitSet()));
  }
  GIVEN("one whose only reader was closed") {
    Bus bus;
    dds::core::cond::WaitSet waitset;
    waitset += dds::sub::cond::ReadCondition(bus.reader, DataState::any());
    bus.reader.close();
    CHECK(waits(waitset));
  }
}

SCENARIO("one call reads or takes all samples, as they were when it began") {
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "many");
  dds::pub::DataWriter<Sample> writer(bus.publisher, topic, reliable_writer(1000));
  dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader(1000));
  REQUIRE(wait_until([&] { return reader.subscription_matched_status().current_count() == 1; }));
  constexpr std::uint32_t count = 600;
  for (std::uint32_t i = 0; i < count; ++i) writer.write(sample(1, std::to_string(i)));

  CHECK((reader.select().max_samples(0x7fffffffU).state(ViewState::not_new_view()).read().length() == 0));
  const auto taken = reader.select().state(DataState::new_instance()).take();
  REQUIRE((taken.length() == count));
  CHECK((codes(taken).back() == "599"));
  CHECK((taken.begin()->info().state().view_state() == ViewState::new_view()));
  CHECK(((taken.end() - 1)->info().state().view_state() == ViewState::new_view()));

  for (std::uint32_t i = 0; i < count; ++i) writer.write(sample(1));
  CHECK((reader.read().length() == count));
  CHECK((reader.select().max_samples(500).take().length() == 500));
  CHECK((reader.take().length() == 100));
}

SCENARIO("nil is no instance") {
  Bus bus;
  CHECK_THROWS_AS(bus.reader.select().instance(dds::core::InstanceHandle::nil()).take(),
                  dds::core::PreconditionNotMetError);
}

/// Waits in its callback, and then uses its reader.
class BlockedListener : public dds::sub::NoOpDataReaderListener<Sample> {
public:
  void on_data_available(dds::sub::DataReader<Sample>& reader) override {
    is_in = true;
    while (!may_leave) std::this_thread::yield();
    name = reader.topic_description().name();
    has_closed = throws_closed([&] { reader.take(); });
  }

  template <class Call>
  static bool throws_closed(Call call) try {
    call();
    return false;
  } catch (const dds::core::AlreadyClosedError&) {
    return true;
  }

  std::atomic<bool> is_in = false;
  std::atomic<bool> may_leave = false;
  std::atomic<bool> has_closed = false;
  std::string name;
};

SCENARIO("a callback that runs while its owner closes keeps its reader") {
  Bus bus;
  BlockedListener listener;
  dds::sub::Subscriber subscriber(bus.participant);
  dds::sub::DataReader<Sample> reader(subscriber, bus.topic, reliable_reader(), &listener,
                                      dds::core::status::StatusMask::data_available());
  std::thread delivery([&] { bus.writer.write(sample(1)); });
  REQUIRE(wait_until([&] { return listener.is_in.load(); }));
  std::thread closing([&] { subscriber.close(); });
  REQUIRE(wait_until([&] { return BlockedListener::throws_closed([&] { ext::handle(subscriber); }); }));
  reader = dds::core::null;  // the last reference, while its owner closes
  listener.may_leave = true;
  closing.join();
  delivery.join();
  CHECK(listener.name == "psm");
  CHECK(listener.has_closed);
  CHECK_THROWS_AS(ext::handle(subscriber), dds::core::AlreadyClosedError);
}

/// Has the last reference to its reader, and drops it.
class EndingListener : public dds::sub::NoOpDataReaderListener<Sample> {
public:
  void on_data_available(dds::sub::DataReader<Sample>& reader) override {
    const dds::sub::DataReader<Sample> kept = reader;  // NOLINT(performance-unnecessary-copy-initialization)
    is_in = true;
    while (!may_leave) std::this_thread::yield();
  }

  std::atomic<bool> is_in = false;
  std::atomic<bool> may_leave = false;
};

SCENARIO("a callback that has the last reference to its reader ends it after itself") {
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "ending");
  EndingListener listener;
  dds::pub::DataWriter<Sample> writer(bus.publisher, topic, reliable_writer());
  dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader(), &listener,
                                      dds::core::status::StatusMask::data_available());
  std::thread delivery([&] { writer.write(sample(1)); });
  REQUIRE(wait_until([&] { return listener.is_in.load(); }));
  reader = dds::core::null;
  listener.may_leave = true;
  delivery.join();
  CHECK(wait_until([&] { return writer.publication_matched_status().current_count() == 0; }));
}

SCENARIO("a wait of ours ends without an exception") {
  using std::chrono::milliseconds;
  dds::core::cond::GuardCondition stop;
  dds::core::cond::WaitSet waitset;
  waitset += stop;
  CHECK_FALSE(ext::wait(waitset, milliseconds(5)));
  CHECK_FALSE(ext::wait(waitset, milliseconds(0)));
  CHECK_FALSE(ext::wait(waitset, milliseconds(-5)));  // already past
  stop.trigger_value(true);
  CHECK(ext::wait(waitset));
  CHECK(ext::wait(waitset, milliseconds(0)));
  CHECK(ext::wait(waitset, milliseconds(-5)));
  CHECK(waitset.detach_condition(stop));
  CHECK_FALSE(waitset.detach_condition(stop));
  CHECK_FALSE(ext::wait(waitset, milliseconds(0)));
}

/// Knows its end.
class EndedListener : public dds::sub::NoOpDataReaderListener<Sample> {
public:
  explicit EndedListener(std::atomic<int>& calls) : calls_(calls) {}
  void on_data_available(dds::sub::DataReader<Sample>&) override { ++calls_; }

private:
  std::atomic<int>& calls_;
};

SCENARIO("a wait set keeps a reader until it is closed") {
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "attached");
  dds::pub::DataWriter<Sample> writer(bus.publisher, topic, reliable_writer());
  std::atomic<int> calls = 0;
  auto listener = std::make_unique<EndedListener>(calls);
  dds::core::cond::WaitSet waitset;
  dds::sub::DataReader<Sample> reader(bus.subscriber, topic, reliable_reader(), listener.get(),
                                      dds::core::status::StatusMask::data_available());
  waitset += dds::sub::cond::ReadCondition(reader, DataState::any());
  const auto matched = [&writer] { return writer.publication_matched_status().current_count(); };
  REQUIRE(wait_until([&] { return matched() == 1; }));
  WHEN("its last other reference ends") {
    reader = dds::core::null;
    THEN("its listener is still called") {
      writer.write(sample(1));
      CHECK(calls.load() == 1);
      CHECK(matched() == 1);
    }
  }
  WHEN("it is closed, and its listener ends") {
    reader.close();
    listener.reset();
    THEN("no callback follows, although the condition is attached") {
      writer.write(sample(1));
      CHECK(calls.load() == 0);
      CHECK(wait_until([&] { return matched() == 0; }));
      CHECK(waitset.conditions().size() == 1);
      CHECK_FALSE(ext::wait(waitset, std::chrono::milliseconds(0)));
    }
  }
}

/// True for an entity that was not deleted.
bool exists(dds_entity_t entity) {
  dds_instance_handle_t instance = 0;
  return dds_get_instance_handle(entity, &instance) == DDS_RETCODE_OK;
}

SCENARIO("an entity ends with its last owner") {
  Bus bus;
  dds::pub::DataWriter<Sample> first(bus.publisher, bus.topic);
  const dds_entity_t moved = ext::handle(first);
  WHEN("it is moved to another one") {
    dds::pub::DataWriter<Sample> second(bus.publisher, bus.topic);
    const dds_entity_t replaced = ext::handle(second);
    second = std::move(first);
    THEN("it has the other's place, whose entity is deleted") {
      CHECK_FALSE(exists(replaced));
      CHECK(ext::handle(second) == moved);
      CHECK((first == dds::core::null));  // NOLINT(bugprone-use-after-move,clang-analyzer-cplusplus.Move)
    }
  }
  WHEN("it is moved to what ends") {
    { const dds::pub::DataWriter<Sample> last = std::move(first); }
    THEN("it is deleted") {
      CHECK_FALSE(exists(moved));
    }
  }
}

SCENARIO("a participant may be replaced by another domain's") {
  const sonopose::test::TestDomain one;
  const sonopose::test::TestDomain other;
  auto participant = ext::participant({.domain_id = one.id()});
  const dds_entity_t before = ext::handle(participant);
  participant = ext::participant({.domain_id = other.id()});
  CHECK(participant.domain_id() == other.id());
  CHECK_FALSE(exists(before));
  // The first domain is closed, so it can be opened with another configuration.
  CHECK_NOTHROW(ext::participant({.domain_id = one.id(), .network = sonopose::dds::Network::lan}));
}

SCENARIO("the QoS of endpoints is the effective one") {
  using namespace dds::core::policy;
  const dds::core::Duration deadline(5, 0);
  Bus bus;
  const dds::topic::Topic<Sample> topic(bus.participant, "effective",
                                        dds::topic::qos::TopicQos() << Deadline(deadline));
  const sonopose::dds::Qos unset;
  dds::pub::DataWriter<Sample> writer(bus.publisher, topic, unset);
  const dds::sub::DataReader<Sample> reader(bus.subscriber, topic, unset);
  CHECK((writer.qos().policy<Deadline>().period() == deadline));
  CHECK((reader.qos().policy<Deadline>().period() == deadline));
  writer.qos(sonopose::dds::Qos() << OwnershipStrength(3));
  CHECK((writer.qos().policy<Deadline>().period() == deadline));
  CHECK((writer.qos().policy<OwnershipStrength>().value() == 3));
}

SCENARIO("what cyclonedds-cxx does not compile, ours does not either") {
  using namespace dds;
  CHECK_FALSE(std::is_convertible_v<pub::qos::PublisherQos, sub::qos::SubscriberQos>);
  CHECK_FALSE(std::is_convertible_v<sub::qos::DataReaderQos, pub::qos::DataWriterQos>);
  CHECK(std::is_convertible_v<topic::qos::TopicQos, pub::qos::DataWriterQos>);
  CHECK_FALSE(std::is_default_constructible_v<core::policy::HistoryKind>);
  CHECK_FALSE(std::three_way_comparable<core::InstanceHandle>);
}

SCENARIO("an entity's handle serves calls in C") {
  const Bus bus;
  dds_guid_t guid{};
  CHECK(dds_get_guid(ext::handle(bus.reader), &guid) == DDS_RETCODE_OK);
}

}  // namespace psm_own_test
