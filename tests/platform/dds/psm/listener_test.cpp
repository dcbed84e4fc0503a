#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace sonopose::dds::test::listener_test {

using Command = sonopose_ResetCommand;
using std::chrono::milliseconds;

const core::status::StatusMask all = core::status::StatusMask::all();

Qos reliable() {
  return Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(64);
}

/// Counts callbacks and lets a test wait for them.
class Recorder : public sub::NoOpDataReaderListener<Command>, public pub::NoOpDataWriterListener<Command> {
public:
  void on_data_available(sub::DataReader<Command>& reader) noexcept override {
    const std::lock_guard lock(mutex_);
    ext::try_take_each(
        reader, [&](const Command& sample, const sub::SampleInfo&) { ids.push_back(sample.request_id); });
    reader_seen = ext::handle(reader);
    changed_.notify_all();
  }
  void on_subscription_matched(sub::DataReader<Command>&,
                               const core::status::SubscriptionMatchedStatus& status) noexcept override {
    set(matched_writers, status.current_count());
  }
  void on_requested_deadline_missed(
      sub::DataReader<Command>&,
      const core::status::RequestedDeadlineMissedStatus& status) noexcept override {
    set(requested_misses, status.total_count());
  }
  void on_requested_incompatible_qos(
      sub::DataReader<Command>&,
      const core::status::RequestedIncompatibleQosStatus& status) noexcept override {
    set(requested_policy, status.last_policy_id());
  }
  void on_liveliness_changed(sub::DataReader<Command>&,
                             const core::status::LivelinessChangedStatus& status) noexcept override {
    set(alive, status.alive_count());
  }
  void on_sample_rejected(sub::DataReader<Command>&,
                          const core::status::SampleRejectedStatus& status) noexcept override {
    set(rejected, status.total_count());
  }
  void on_publication_matched(pub::DataWriter<Command>&,
                              const core::status::PublicationMatchedStatus& status) noexcept override {
    set(matched_readers, status.current_count());
  }
  void on_offered_deadline_missed(pub::DataWriter<Command>&,
                                  const core::status::OfferedDeadlineMissedStatus& status) noexcept override {
    set(offered_misses, status.total_count());
  }
  void on_offered_incompatible_qos(
      pub::DataWriter<Command>&, const core::status::OfferedIncompatibleQosStatus& status) noexcept override {
    set(offered_policy, status.last_policy_id());
  }
  void on_liveliness_lost(pub::DataWriter<Command>&,
                          const core::status::LivelinessLostStatus& status) noexcept override {
    set(liveliness_lost, status.total_count());
  }

  template <class Done>
  bool wait(Done done) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, test_timeout, done);
  }

  std::vector<std::uint64_t> ids;
  dds_entity_t reader_seen = 0;
  std::uint32_t matched_writers = 0, requested_misses = 0, requested_policy = 0, alive = 0, rejected = 0;
  std::uint32_t matched_readers = 0, offered_misses = 0, offered_policy = 0, liveliness_lost = 0;

private:
  void set(std::uint32_t& what, auto value) {
    const std::lock_guard lock(mutex_);
    what = static_cast<std::uint32_t>(value);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
};

TEST_CASE("A listener receives data that existed when its reader was created") {
  GIVEN("a transient-local writer that has written already") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/listener_at_once");
    const Qos qos = reliable() << policy::Durability::TransientLocal();
    pub::DataWriter<Command> writer(pub::Publisher(member), topic, qos);
    writer.write(command(7, 1));

    WHEN("a reader with a listener is made and nothing is written any more") {
      Recorder recorder;
      const sub::DataReader<Command> reader(sub::Subscriber(member), topic, qos, &recorder, all);
      THEN("the listener gets the sample, through its own reader") {
        REQUIRE(recorder.wait([&] { return !recorder.ids.empty(); }));
        CHECK(recorder.ids == std::vector<std::uint64_t>{1});
        CHECK(recorder.reader_seen == ext::handle(reader));
        CHECK(recorder.wait([&] { return recorder.matched_writers == 1; }));
      }
    }
  }
}

TEST_CASE("A listener is called for every sample in order, also after its reader was moved") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/listener_order");
  Recorder recorder;
  sub::DataReader<Command> made(sub::Subscriber(member), topic, reliable(), &recorder, all);
  const sub::DataReader<Command> reader = std::move(made);
  Recorder writers_recorder;
  pub::DataWriter<Command> writer(pub::Publisher(member), topic, reliable(), &writers_recorder, all);
  REQUIRE(writers_recorder.wait([&] { return writers_recorder.matched_readers == 1; }));
  REQUIRE(recorder.wait([&] { return recorder.matched_writers == 1 && recorder.alive == 1; }));
  for (std::uint64_t id = 1; id <= 500; ++id) writer.write(command(7, id));
  REQUIRE(recorder.wait([&] { return recorder.ids.size() == 500; }));
  for (std::size_t i = 0; i < 500; ++i) CHECK(recorder.ids[i] == i + 1);
  writer.close();
  CHECK(recorder.wait([&] { return recorder.matched_writers == 0 && recorder.alive == 0; }));
}

TEST_CASE("Every status reaches its callback") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/listener_statuses");
  Recorder of_reader;
  Recorder of_writer;
  SECTION("deadlines") {
    const Qos qos = reliable() << policy::Deadline(ext::to_duration(milliseconds(30)));
    const sub::DataReader<Command> reader(sub::Subscriber(member), topic, qos, &of_reader, all);
    pub::DataWriter<Command> writer(pub::Publisher(member), topic, qos, &of_writer, all);
    writer.write(command(7, 1));
    CHECK(of_reader.wait([&] { return of_reader.requested_misses > 0; }));
    CHECK(of_writer.wait([&] { return of_writer.offered_misses > 0; }));
  }
  SECTION("incompatible QoS") {
    const sub::DataReader<Command> reader(sub::Subscriber(member), topic, reliable(), &of_reader, all);
    const pub::DataWriter<Command> writer(pub::Publisher(member), topic,
                                          Qos() << policy::Reliability::BestEffort(), &of_writer, all);
    CHECK(of_reader.wait([&] { return of_reader.requested_policy == DDS_RELIABILITY_QOS_POLICY_ID; }));
    CHECK(of_writer.wait([&] { return of_writer.offered_policy == DDS_RELIABILITY_QOS_POLICY_ID; }));
  }
  SECTION("liveliness") {
    const Qos qos = reliable() << policy::Liveliness(policy::LivelinessKind::MANUAL_BY_TOPIC,
                                                     ext::to_duration(milliseconds(30)));
    const sub::DataReader<Command> reader(sub::Subscriber(member), topic, qos, &of_reader, all);
    const pub::DataWriter<Command> writer(pub::Publisher(member), topic, qos, &of_writer, all);
    CHECK(of_writer.wait([&] { return of_writer.liveliness_lost > 0; }));
    CHECK(of_reader.wait([&] { return of_reader.matched_writers == 1 && of_reader.alive == 0; }));
  }
  SECTION("rejected samples") {
    const Qos full = reliable() << policy::History::KeepAll() << policy::ResourceLimits(1, 1, 1);
    const core::status::StatusMask no_data = ext::all_but(core::status::StatusMask::data_available());
    const sub::DataReader<Command> reader(sub::Subscriber(member), topic, full, &of_reader, no_data);
    pub::DataWriter<Command> writer(pub::Publisher(member), topic,
                                    reliable()
                                        << policy::Reliability::Reliable(ext::to_duration(milliseconds(5))));
    REQUIRE(of_reader.wait([&] { return of_reader.matched_writers == 1; }));
    writer.write(command(7, 1));
    CHECK(ext::try_write(writer, command(7, 2)) == DDS_RETCODE_TIMEOUT);
    CHECK(of_reader.wait([&] { return of_reader.rejected > 0; }));
    CHECK(of_reader.ids.empty());  // data was masked out
  }
}

/// Stays in its callback for 100 ms.
class Slow : public sub::NoOpDataReaderListener<Command> {
public:
  void on_data_available(sub::DataReader<Command>&) noexcept override {
    inside = true;
    inside.notify_all();
    std::this_thread::sleep_for(milliseconds(100));  // time for a destructor that does not wait
    finished = true;
  }
  std::atomic<bool> inside = false;
  std::atomic<bool> finished = false;
};

TEST_CASE("Destroying a reader waits for a running callback") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/listener_destroyed");
  pub::DataWriter<Command> writer(pub::Publisher(member), topic, reliable());
  Slow slow;
  {
    sub::DataReader<Command> reader(sub::Subscriber(member), topic, reliable(), &slow, all);
    REQUIRE(matched(reader));
    std::thread writing([&] { writer.write(command(7, 1)); });
    slow.inside.wait(false);
    reader.close();
    CHECK(slow.finished);
    writing.join();
  }
}

}  // namespace sonopose::dds::test::listener_test
