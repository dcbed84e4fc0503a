#include "dds/dds_fixture.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>
#include <utility>

namespace sonopose::dds::test::status_test {

using Command = sonopose_ResetCommand;
using std::chrono::milliseconds;

Qos reliable() {
  return Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(16);
}

TEST_CASE("Incompatible QoS is reported on both sides, with the policy") {
  struct Case {
    const char* what;
    Qos offered;
    Qos requested;
    dds_qos_policy_id_t policy;
  };
  const std::vector<Case> cases{
      {"reliability", Qos() << policy::Reliability::BestEffort(), reliable(), DDS_RELIABILITY_QOS_POLICY_ID},
      {"durability", reliable(), reliable() << policy::Durability::TransientLocal(),
       DDS_DURABILITY_QOS_POLICY_ID},
      {"deadline", reliable() << policy::Deadline(ext::to_duration(milliseconds(200))),
       reliable() << policy::Deadline(ext::to_duration(milliseconds(100))), DDS_DEADLINE_QOS_POLICY_ID},
      {"ownership", reliable() << policy::Ownership::Exclusive(), reliable(), DDS_OWNERSHIP_QOS_POLICY_ID},
      {"liveliness", reliable(),
       reliable() << policy::Liveliness(policy::LivelinessKind::MANUAL_BY_TOPIC,
                                        ext::to_duration(milliseconds(500))),
       DDS_LIVELINESS_QOS_POLICY_ID},
  };
  const domain::DomainParticipant member = participant();
  for (const Case& c : cases) {
    DYNAMIC_SECTION(c.what) {
      const topic::Topic<Command> topic(member, std::string("test/incompatible_") + c.what);
      sub::DataReader<Command> reader(sub::Subscriber(member), topic, c.requested);
      pub::DataWriter<Command> writer(pub::Publisher(member), topic, c.offered);

      core::status::RequestedIncompatibleQosStatus requested{};
      REQUIRE(wait_for(reader, core::status::StatusMask::requested_incompatible_qos(), [&] {
        requested = reader.requested_incompatible_qos_status();
        return requested.total_count() > 0;
      }));
      CHECK(requested.total_count() == 1);
      CHECK(requested.last_policy_id() == static_cast<std::uint32_t>(c.policy));

      core::status::OfferedIncompatibleQosStatus offered{};
      REQUIRE(wait_for(writer, core::status::StatusMask::offered_incompatible_qos(), [&] {
        offered = writer.offered_incompatible_qos_status();
        return offered.total_count() > 0;
      }));
      CHECK(offered.total_count() == 1);
      CHECK(offered.last_policy_id() == static_cast<std::uint32_t>(c.policy));

      CHECK(reader.subscription_matched_status().total_count() == 0);
      CHECK(writer.publication_matched_status().total_count() == 0);
      CHECK(ext::matched_publications(reader).empty());
    }
  }
}

TEST_CASE("A missed deadline is reported on both sides until the instance is unregistered") {
  GIVEN("a writer that offers a sample every 50 ms, and has written one") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/deadline");
    const Qos qos = reliable() << policy::Deadline(ext::to_duration(milliseconds(50)));
    sub::DataReader<Command> reader(sub::Subscriber(member), topic, qos);
    pub::DataWriter<Command> writer(pub::Publisher(member), topic, qos);
    REQUIRE(matched(reader));
    writer.write(command(7, 1));

    WHEN("it writes no more") {
      THEN("reader and writer count the misses and name the instance") {
        core::status::RequestedDeadlineMissedStatus requested{};
        REQUIRE(wait_for(reader, core::status::StatusMask::requested_deadline_missed(), [&] {
          requested = reader.requested_deadline_missed_status();
          return requested.total_count() >= 2;
        }));
        CHECK_FALSE(requested.last_instance_handle().is_nil());
        core::status::OfferedDeadlineMissedStatus offered{};
        REQUIRE(wait_for(writer, core::status::StatusMask::offered_deadline_missed(), [&] {
          offered = writer.offered_deadline_missed_status();
          return offered.total_count() >= 2;
        }));

        AND_WHEN("the instance is unregistered") {
          writer.unregister_instance(command(7, 0));
          const std::int32_t before = reader.requested_deadline_missed_status().total_count();
          THEN("no further miss comes within five periods") {
            CHECK_FALSE(wait_for(
                reader, core::status::StatusMask::requested_deadline_missed(),
                [&] { return reader.requested_deadline_missed_status().total_count() > before; },
                milliseconds(250)));
          }
        }
      }
    }
  }
}

Qos manual_liveliness(std::chrono::nanoseconds lease) {
  return reliable() << policy::Liveliness(policy::LivelinessKind::MANUAL_BY_TOPIC, ext::to_duration(lease));
}

TEST_CASE("A writer that does not assert its liveliness is not alive until it writes") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/liveliness");
  sub::DataReader<Command> reader(sub::Subscriber(member), topic, manual_liveliness(milliseconds(50)));
  pub::DataWriter<Command> writer(pub::Publisher(member), topic, manual_liveliness(milliseconds(50)));
  REQUIRE(matched(reader));

  core::status::LivelinessChangedStatus status{};
  const auto lost = [&] {
    return wait_for(reader, core::status::StatusMask::liveliness_changed(), [&] {
      status = reader.liveliness_changed_status();
      return status.alive_count() == 0 && status.not_alive_count() == 1;
    });
  };
  REQUIRE(lost());
  CHECK(status.last_publication_handle() == writer.instance_handle());
  CHECK(wait_for(writer, core::status::StatusMask::liveliness_lost(),
                 [&] { return writer.liveliness_lost_status().total_count() == 1; }));

  // A write restores the liveliness, which can then be lost again.
  writer.write(command(7, 1));
  CHECK(wait_for(writer, core::status::StatusMask::liveliness_lost(),
                 [&] { return writer.liveliness_lost_status().total_count() == 2; }));
}

TEST_CASE("A writer that asserts its liveliness in time keeps it without writing") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/assert_liveliness");
  const milliseconds lease(300);
  pub::DataWriter<Command> writer(pub::Publisher(member), topic, manual_liveliness(lease));
  const auto lost = [&writer] { return writer.liveliness_lost_status().total_count(); };
  // Asserts the liveliness for two leases. Returns false if a busy machine delayed this by half a lease.
  std::int32_t lost_before = 0;
  const auto assert_in_time = [&] {
    REQUIRE(ext::try_assert_liveliness(writer) >= 0);
    lost_before = lost();
    auto asserted = std::chrono::steady_clock::now();
    const auto end = asserted + 2 * lease;
    while (asserted < end) {
      std::this_thread::sleep_for(milliseconds(20));
      REQUIRE(ext::try_assert_liveliness(writer) >= 0);
      const auto last = std::exchange(asserted, std::chrono::steady_clock::now());
      if (asserted - last > lease / 2) return false;
    }
    return true;
  };
  REQUIRE(sonopose::test::wait_until(assert_in_time));
  CHECK(lost() == lost_before);
  CHECK(wait_for(writer, core::status::StatusMask::liveliness_lost(),
                 [&] { return lost() == lost_before + 1; }));
}

TEST_CASE("A full reader makes a lossless writer wait, and nothing is lost") {
  GIVEN("a reader with room for two samples, full") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/rejected");
    const Qos keep_all = Qos() << policy::Reliability::Reliable(ext::to_duration(milliseconds(20)))
                               << policy::History::KeepAll();
    sub::DataReader<Command> reader(sub::Subscriber(member), topic,
                                    Qos(keep_all) << policy::ResourceLimits(2, 1, 2));
    pub::DataWriter<Command> writer(pub::Publisher(member), topic, keep_all);
    REQUIRE(matched(reader));
    writer.write(command(7, 1));
    writer.write(command(7, 2));

    WHEN("one more is written") {
      CHECK(ext::try_write(writer, command(7, 3)) == DDS_RETCODE_TIMEOUT);
      THEN("both sides know, and it fits in once there is room") {
        const core::status::SampleRejectedStatus rejected = reader.sample_rejected_status();
        CHECK(rejected.total_count() >= 1);
        CHECK(reader.take().length() == 2);
      }
    }
    WHEN("the caller cancels the write") {
      int asked = 0;
      const auto give_up = [&] { return ++asked == 3; };
      CHECK(ext::retry_unless(give_up, [&] { return ext::try_write(writer, command(7, 3)); }) ==
            DDS_RETCODE_TIMEOUT);
      THEN("it asked after each try") {
        CHECK(asked == 3);
      }
    }
    WHEN("room is made while it tries again") {
      std::vector<std::uint64_t> ids;
      const auto make_room = [&] {
        ext::take_each(
            reader, [&](const Command& sample, const sub::SampleInfo&) { ids.push_back(sample.request_id); });
        reader.close();
        return false;
      };
      CHECK(ext::retry_unless(make_room, [&] { return ext::try_write(writer, command(8, 3)); }) >= 0);
      THEN("what was there has been taken") {
        CHECK(ids == std::vector<std::uint64_t>{1, 2});
      }
    }
  }
}

}  // namespace sonopose::dds::test::status_test
