/// Wait sets and conditions of the PSM.

#include "platform/dds/psm/psm_fixture.hpp"

#include <catch2/catch.hpp>

namespace psm_conditions_test {

using namespace psm_fixture;
using dds::core::status::StatusMask;
using dds::sub::status::DataState;

SCENARIO("a wait set returns the conditions that are true") {
  GIVEN("a wait set with a read condition, a status condition and a guard condition") {
    Bus bus;
    dds::sub::cond::ReadCondition has_data(bus.reader, DataState::new_data());
    dds::core::cond::StatusCondition changed(bus.writer);
    changed.enabled_statuses(StatusMask::publication_matched());
    dds::core::cond::GuardCondition guard;
    dds::core::cond::WaitSet waitset;
    waitset += has_data;
    waitset += changed;
    waitset += guard;
    waitset += guard;
    CHECK((waitset.conditions().size() == 3));
    CHECK((changed.enabled_statuses() == StatusMask::publication_matched()));
    CHECK((changed.entity().instance_handle() == bus.writer.instance_handle()));
    CHECK((has_data.data_reader().instance_handle() == bus.reader.instance_handle()));

    WHEN("none is true") {
      THEN("waiting times out") {
        CHECK_THROWS_AS(waitset.wait(dds::core::Duration::from_millisecs(1)), dds::core::TimeoutError);
        CHECK_THROWS_AS(waitset.wait(dds::core::Duration::zero()), dds::core::TimeoutError);
        CHECK_FALSE(has_data.trigger_value());
      }
    }
    WHEN("a sample arrives") {
      bus.writer.write(sample(1));
      const auto active = waitset.wait(timeout);
      THEN("the read condition is returned, until the sample is taken") {
        REQUIRE((active.size() == 1));
        CHECK((active.front() == has_data));
        CHECK(has_data.trigger_value());
        bus.reader.take();
        CHECK_FALSE(has_data.trigger_value());
      }
    }
    WHEN("the guard is set by another thread") {
      std::thread other([guard]() mutable { guard.trigger_value(true); });
      const auto active = waitset.wait(timeout);
      other.join();
      THEN("it is returned until it is reset") {
        REQUIRE((active.size() == 1));
        CHECK((active.front() == guard));
        guard.trigger_value(false);
        CHECK_FALSE(guard.trigger_value());
      }
    }
    WHEN("a second reader matches") {
      const dds::sub::DataReader<Sample> second(bus.subscriber, bus.topic, reliable_reader());
      const auto active = waitset.wait(timeout);
      THEN("the status condition is returned, which an entity has once") {
        REQUIRE((active.size() == 1));
        CHECK((active.front() == dds::core::cond::StatusCondition(bus.writer)));
        CHECK((bus.writer.status_changes() == StatusMask::publication_matched()));
        CHECK((bus.writer.publication_matched_status().current_count() == 2));
        CHECK_FALSE(changed.trigger_value());
      }
    }
    WHEN("a condition is detached") {
      waitset -= has_data;
      bus.writer.write(sample(1));
      THEN("it wakes nobody") {
        CHECK_THROWS_AS(waitset.wait(dds::core::Duration::zero()), dds::core::TimeoutError);
        CHECK_FALSE(waitset.detach_condition(has_data));
      }
    }
  }
}

SCENARIO("dispatch calls the handlers of the conditions that are true") {
  Bus bus;
  int calls = 0;
  int others = 0;
  dds::sub::cond::ReadCondition has_data(bus.reader, DataState::any(), [&](dds::core::cond::Condition&) {
    ++calls;
    bus.reader.take();
  });
  dds::core::cond::GuardCondition guard([&others](dds::core::cond::Condition&) { ++others; });
  dds::core::cond::WaitSet waitset;
  waitset.attach_condition(has_data);
  waitset.attach_condition(guard);
  bus.writer.write(sample(1));
  waitset.dispatch(timeout);
  CHECK((calls == 1));  // by wait, after which the condition is false
  CHECK((others == 0));
  CHECK((bus.reader.read().length() == 0));
  CHECK_THROWS_AS(waitset.dispatch(dds::core::Duration::zero()), dds::core::TimeoutError);
}

SCENARIO("a closed condition can be detached") {
  Bus bus;
  dds::core::cond::WaitSet waitset;
  dds::sub::cond::ReadCondition has_data(bus.reader, DataState::any());
  dds::core::cond::StatusCondition changed(bus.reader);
  waitset += has_data;
  waitset += changed;
  bus.reader.close();
  CHECK_FALSE(waitset.detach_condition(changed));  // closing the reader has detached them
  CHECK_FALSE(waitset.detach_condition(has_data));
  CHECK((waitset.conditions().empty()));
}

}  // namespace psm_conditions_test
