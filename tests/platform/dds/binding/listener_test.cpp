#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace sonopose::dds::test::listener_test {

using Command = sonopose_ResetCommand;
using std::chrono::milliseconds;

Qos reliable() {
  return Qos() << policy::Reliability::reliable() << policy::History::keep_last(64);
}

static_assert(noexcept(
    std::declval<DataReaderListener<Command>&>().on_data_available(std::declval<DataReader<Command>&>())));

/// Counts callbacks and lets a test wait for them.
class Recorder : public DataReaderListener<Command>, public DataWriterListener<Command> {
public:
  void on_data_available(DataReader<Command>& reader) noexcept override {
    const std::lock_guard lock(mutex_);
    reader.try_take_each([&](const Command& sample, const SampleInfo&) { ids.push_back(sample.request_id); });
    reader_seen = reader.handle();
    changed_.notify_all();
  }
  void on_subscription_matched(DataReader<Command>&,
                               const SubscriptionMatchedStatus& status) noexcept override {
    set(matched_writers, status.current_count);
  }
  void on_requested_deadline_missed(DataReader<Command>&,
                                    const RequestedDeadlineMissedStatus& status) noexcept override {
    set(requested_misses, status.total_count);
  }
  void on_requested_incompatible_qos(DataReader<Command>&,
                                     const RequestedIncompatibleQosStatus& status) noexcept override {
    set(requested_policy, status.last_policy_id);
  }
  void on_liveliness_changed(DataReader<Command>&, const LivelinessChangedStatus& status) noexcept override {
    set(alive, status.alive_count);
  }
  void on_sample_rejected(DataReader<Command>&, const SampleRejectedStatus& status) noexcept override {
    set(rejected, status.total_count);
  }
  void on_publication_matched(DataWriter<Command>&,
                              const PublicationMatchedStatus& status) noexcept override {
    set(matched_readers, status.current_count);
  }
  void on_offered_deadline_missed(DataWriter<Command>&,
                                  const OfferedDeadlineMissedStatus& status) noexcept override {
    set(offered_misses, status.total_count);
  }
  void on_offered_incompatible_qos(DataWriter<Command>&,
                                   const OfferedIncompatibleQosStatus& status) noexcept override {
    set(offered_policy, status.last_policy_id);
  }
  void on_liveliness_lost(DataWriter<Command>&, const LivelinessLostStatus& status) noexcept override {
    set(liveliness_lost, status.total_count);
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
  void set(std::uint32_t& what, std::uint32_t value) {
    const std::lock_guard lock(mutex_);
    what = value;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
};

TEST_CASE("A listener receives data that existed when its reader was created") {
  GIVEN("a transient-local writer that has written already") {
    const DomainParticipant member = participant();
    const Topic<Command> topic(member, "test/listener_at_once");
    const Qos qos = reliable() << policy::Durability{policy::DurabilityKind::transient_local};
    DataWriter<Command> writer(member, topic, qos);
    writer.write(command(7, 1));

    WHEN("a reader with a listener is made and nothing is written any more") {
      Recorder recorder;
      const DataReader<Command> reader(member, topic, qos, &recorder);
      THEN("the listener gets the sample, through its own reader") {
        REQUIRE(recorder.wait([&] { return !recorder.ids.empty(); }));
        CHECK(recorder.ids == std::vector<std::uint64_t>{1});
        CHECK(recorder.reader_seen == reader.handle());
        CHECK(recorder.wait([&] { return recorder.matched_writers == 1; }));
      }
    }
  }
}

TEST_CASE("A listener is called for every sample in order, also after its reader was moved") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/listener_order");
  Recorder recorder;
  DataReader<Command> made(member, topic, reliable(), &recorder);
  const DataReader<Command> reader = std::move(made);
  Recorder writers_recorder;
  DataWriter<Command> writer(member, topic, reliable(), &writers_recorder);
  REQUIRE(writers_recorder.wait([&] { return writers_recorder.matched_readers == 1; }));
  REQUIRE(recorder.wait([&] { return recorder.matched_writers == 1 && recorder.alive == 1; }));
  for (std::uint64_t id = 1; id <= 500; ++id) writer.write(command(7, id));
  REQUIRE(recorder.wait([&] { return recorder.ids.size() == 500; }));
  for (std::size_t i = 0; i < 500; ++i) CHECK(recorder.ids[i] == i + 1);
  writer.close();
  CHECK(recorder.wait([&] { return recorder.matched_writers == 0 && recorder.alive == 0; }));
}

TEST_CASE("Every status reaches its callback") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/listener_statuses");
  Recorder of_reader;
  Recorder of_writer;
  SECTION("deadlines") {
    const Qos qos = reliable() << policy::Deadline{milliseconds(30)};
    const DataReader<Command> reader(member, topic, qos, &of_reader);
    DataWriter<Command> writer(member, topic, qos, &of_writer);
    writer.write(command(7, 1));
    CHECK(of_reader.wait([&] { return of_reader.requested_misses > 0; }));
    CHECK(of_writer.wait([&] { return of_writer.offered_misses > 0; }));
  }
  SECTION("incompatible QoS") {
    const DataReader<Command> reader(member, topic, reliable(), &of_reader);
    const DataWriter<Command> writer(member, topic, Qos() << policy::Reliability::best_effort(), &of_writer);
    CHECK(of_reader.wait([&] { return of_reader.requested_policy == DDS_RELIABILITY_QOS_POLICY_ID; }));
    CHECK(of_writer.wait([&] { return of_writer.offered_policy == DDS_RELIABILITY_QOS_POLICY_ID; }));
  }
  SECTION("liveliness") {
    const Qos qos =
        reliable() << policy::Liveliness{policy::LivelinessKind::manual_by_topic, milliseconds(30)};
    const DataReader<Command> reader(member, topic, qos, &of_reader);
    const DataWriter<Command> writer(member, topic, qos, &of_writer);
    CHECK(of_writer.wait([&] { return of_writer.liveliness_lost > 0; }));
    CHECK(of_reader.wait([&] { return of_reader.matched_writers == 1 && of_reader.alive == 0; }));
  }
  SECTION("rejected samples") {
    const Qos full = reliable() << policy::History::keep_all() << policy::ResourceLimits{1, 1, 1};
    const StatusMask no_data{StatusMask::all().mask & ~StatusMask::data_available().mask};
    const DataReader<Command> reader(member, topic, full, &of_reader, no_data);
    DataWriter<Command> writer(member, topic, reliable() << policy::Reliability::reliable(milliseconds(5)));
    REQUIRE(of_reader.wait([&] { return of_reader.matched_writers == 1; }));
    writer.write(command(7, 1));
    CHECK(writer.try_write(command(7, 2)) == DDS_RETCODE_TIMEOUT);
    CHECK(of_reader.wait([&] { return of_reader.rejected > 0; }));
    CHECK(of_reader.ids.empty());  // data was masked out
  }
}

/// Stays in its callback for 100 ms.
class Slow : public DataReaderListener<Command> {
public:
  void on_data_available(DataReader<Command>&) noexcept override {
    inside = true;
    inside.notify_all();
    std::this_thread::sleep_for(milliseconds(100));  // time for a destructor that does not wait
    finished = true;
  }
  std::atomic<bool> inside = false;
  std::atomic<bool> finished = false;
};

TEST_CASE("Destroying a reader waits for a running callback") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/listener_destroyed");
  DataWriter<Command> writer(member, topic, reliable());
  Slow slow;
  {
    DataReader<Command> reader(member, topic, reliable(), &slow);
    REQUIRE(matched(reader));
    std::thread writing([&] { writer.write(command(7, 1)); });
    slow.inside.wait(false);
    reader.close();
    CHECK(slow.finished);
    writing.join();
  }
}

}  // namespace sonopose::dds::test::listener_test
