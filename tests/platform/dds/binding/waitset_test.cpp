#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <thread>

namespace sonopose::dds::test::waitset_test {

using Command = sonopose_ResetCommand;
using std::chrono::milliseconds;

TEST_CASE("A wait set wakes for a true condition and returns it") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/waitset");
  const Qos qos = Qos() << policy::Reliability::reliable();
  DataReader<Command> reader(member, topic, qos);
  DataWriter<Command> writer(member, topic, qos);
  REQUIRE(matched(reader));
  const ReadCondition data(reader, DataState::new_data());
  GuardCondition stop;
  WaitSet waitset;
  waitset += data;
  waitset += stop;

  SECTION("nothing happens: the timeout is a result") {
    CHECK(waitset.wait(milliseconds(5)) == 0);
    CHECK(waitset.wait(Duration::zero()) == 0);
    CHECK(waitset.wait(milliseconds(-5)) == 0);  // already past
  }
  SECTION("data") {
    writer.write(command(7, 1));
    CHECK(waitset.wait(test_timeout) == 1);
    CHECK(data.trigger_value());
    CHECK_FALSE(stop.trigger_value());
    CHECK(reader.read().size() == 1);
    CHECK_FALSE(data.trigger_value());  // no longer new
    CHECK(waitset.wait(Duration::zero()) == 0);
    CHECK(reader.read(256, DataState::new_data()).empty());
    CHECK(reader.take().size() == 1);
  }
  SECTION("another thread") {
    std::thread other([&] { stop.trigger_value(true); });
    CHECK(waitset.wait(test_timeout) == 1);
    CHECK(stop.trigger_value());
    other.join();
    stop.trigger_value(false);
    CHECK(waitset.wait(Duration::zero()) == 0);
  }
  SECTION("a removed condition does not wake the set") {
    waitset -= data;
    writer.write(command(7, 1));
    CHECK(waitset.wait(Duration::zero()) == 0);
    CHECK_THROWS_AS(waitset -= data, Error);
  }
  SECTION("a status, of those that are enabled") {
    StatusCondition status(reader);
    status.enabled_statuses(StatusMask::subscription_matched());
    CHECK(status.enabled_statuses().mask == StatusMask::subscription_matched().mask);
    waitset += status;
    reader.subscription_matched_status();
    CHECK(waitset.wait(Duration::zero()) == 0);
    writer.close();
    CHECK(waitset.wait(test_timeout) >= 1);
    CHECK(status.trigger_value());
    CHECK(reader.status_changes().test(StatusMask::subscription_matched()));
    CHECK(reader.subscription_matched_status().current_count == 0);
    CHECK_FALSE(status.trigger_value());
  }
}

}  // namespace sonopose::dds::test::waitset_test
