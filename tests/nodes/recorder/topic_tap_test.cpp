#include "recorder/topic_tap.hpp"

#include "bus_log/instance_end.hpp"
#include "dds/dds_fixture.hpp"
#include "mcap/chunk_messages.hpp"
#include "recorder/messages.hpp"
#include "recorder/raw_ends.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace sonopose::recorder::test::topic_tap_test {

using dds::core::status::StatusMask;
namespace policy = dds::policy;
using Change = dds::ext::Change;

dds::Qos reliable(policy::OwnershipKind::Type ownership = policy::OwnershipKind::SHARED) {
  return dds::Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(100)
                    << policy::Ownership(ownership);
}

/// A topic with a tap. Within one process a write delivers on the writing thread before it returns.
struct Bus {
  explicit Bus(const dds::Qos& reader_qos, bool is_exclusive = false)
      : tap({.name = "sonopose/reset", .is_exclusive = is_exclusive},
            {.queue = queue, .channel_id = 1, .ends_channel_id = 2}) {
    tap.open(
        {dds::sub::Subscriber(member), dds::ext::serialized(topic), reader_qos, &tap, StatusMask::all()});
  }

  dds::SerializedWriter make_writer(const dds::Qos& qos) {
    dds::SerializedWriter writer(dds::pub::Publisher(member), dds::ext::serialized(topic), qos);
    REQUIRE(dds::test::wait_for(writer, StatusMask::publication_matched(),
                                [&] { return writer.publication_matched_status().current_count() == 1; }));
    return writer;
  }

  mcap::Chunk taken() {
    mcap::Chunk chunk = queue.make_chunk();
    queue.exchange(chunk);
    return chunk;
  }

  dds::domain::DomainParticipant member = dds::test::participant();
  dds::topic::Topic<sonopose_ResetCommand> topic{member, "test/tap"};
  ChunkQueue queue{1U << 20U};
  TopicTap tap;
};

TEST_CASE("A message of a writer that gives no time was published when it arrived") {
  Bus bus(reliable());
  auto writer = bus.make_writer(reliable());
  dds::ext::forward(writer, command_cdr(7, 1), 5);
  dds::ext::forward(writer, command_cdr(7, 2), 0);
  dds::ext::forward(writer, command_cdr(7, 0), 0, Change::dispose);
  const mcap::Chunk chunk = bus.taken();
  REQUIRE(chunk.message_count() == 3);
  CHECK(message_at(chunk, chunk.entries()[0]).publish_time_ns == 5);
  for (std::size_t i = 1; i < 3; ++i) {
    const mcap::Message message = message_at(chunk, chunk.entries()[i]);
    CHECK(message.publish_time_ns == message.log_time_ns);
  }
  std::uint32_t sequence = 4;
  const mcap::Chunk text_chunk = with_ends_as_text(
      chunk, 2, [](std::uint16_t /*channel_id*/) { return "sonopose/reset"; }, sequence);
  REQUIRE(text_chunk.message_count() == 3);
  const mcap::Message end = message_at(text_chunk, text_chunk.entries()[2]);
  const std::string text(reinterpret_cast<const char*>(end.data.data()),  // NOLINT(*-reinterpret-cast): text
                         end.data.size());
  const bus_log::InstanceEnd ended = bus_log::instance_end_of(text);
  CHECK(end.sequence == 5);
  CHECK(sequence == 5);
  CHECK(ended.topic == "sonopose/reset");
  CHECK(ended.disposed);
  CHECK(dds::topics::beacon_of(ended.key_cdr) == 7);
  CHECK(ended.source_time_ns == static_cast<std::int64_t>(end.log_time_ns));
}

TEST_CASE("What DDS drops of a weaker writer is no loss") {
  const bool is_known = GENERATE(true, false);
  Bus bus(reliable(policy::OwnershipKind::EXCLUSIVE), is_known);
  const auto qos_of = [](std::int32_t strength) {
    return reliable(policy::OwnershipKind::EXCLUSIVE) << policy::OwnershipStrength(strength);
  };
  auto strong = bus.make_writer(qos_of(2));
  auto weak = bus.make_writer(qos_of(1));
  dds::ext::forward(strong, command_cdr(7, 1), 1);
  dds::ext::forward(weak, command_cdr(7, 2), 2);
  CHECK(bus.taken().message_count() == 1);
  CHECK(bus.tap.counts() == TapCounts{.received = 1, .lost_dds = is_known ? 0U : 1U});
}

}  // namespace sonopose::recorder::test::topic_tap_test
