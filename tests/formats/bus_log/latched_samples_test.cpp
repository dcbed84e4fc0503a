#include "bus_log/latched_samples.hpp"

#include "bus_log/instance_end.hpp"
#include "mcap/chunk_messages.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

namespace sonopose::latched_samples_test {

using bus_log::LatchedSamples;

/// A serialized reset command: the smallest native type.
std::vector<std::byte> command_cdr(BeaconAddress address, std::uint64_t id) {
  return dds::write_cdr(sonopose_ResetCommand{.address = address, .request_id = id}, std::endian::little);
}

constexpr std::uint16_t estimate_channel = 1;
constexpr std::uint16_t ends_channel = 2;

/// Start of an estimate: beacon and fusion are its key and are laid out like the fields of a command.
std::vector<std::byte> estimate_cdr(BeaconAddress address, std::uint64_t fusion_id) {
  return command_cdr(address, fusion_id);
}

struct Latched {
  LatchedSamples samples{{{estimate_channel, dds::topics::find_topic("estimate")}}, ends_channel};

  void on_estimate(BeaconAddress address, std::uint64_t fusion_id) {
    add(estimate_channel, estimate_cdr(address, fusion_id));
  }
  void on_end(BeaconAddress address, std::uint64_t fusion_id) {
    const std::string text = bus_log::json_of({.topic = "sonopose/estimate",
                                               .disposed = false,
                                               .key_cdr = estimate_cdr(address, fusion_id),
                                               .source_time_ns = 1});
    const auto bytes = std::as_bytes(std::span(text));
    add(ends_channel, {bytes.begin(), bytes.end()});
  }
  void add(std::uint16_t channel_id, const std::vector<std::byte>& data) {
    mcap::Chunk chunk;
    chunk.add({channel_id, 1, 100, 100, data});
    samples.on(chunk);
  }
};

SCENARIO("the latest sample of each instance is kept, whatever its key is") {
  GIVEN("estimates of two fusions of beacon 7, each twice") {
    Latched latched;
    for (int i = 0; i < 2; ++i) {
      latched.on_estimate(7, 1000);
      latched.on_estimate(7, 2000);
    }
    THEN("the latest of both is kept") {
      CHECK(latched.samples.chunk_at(9).message_count() == 2);
    }
    WHEN("one of the fusions ends") {
      latched.on_end(7, 1000);
      THEN("that of the other is kept") {
        CHECK(latched.samples.chunk_at(9).message_count() == 1);
      }
    }
    WHEN("another instance ends") {
      latched.on_end(8, 1000);
      THEN("both are kept") {
        CHECK(latched.samples.chunk_at(9).message_count() == 2);
      }
    }
  }
}

SCENARIO("a channel without keys keeps what its programs have said") {
  GIVEN("two static transforms, one of them twice") {
    constexpr std::uint16_t plain_channel = 3;
    Latched latched;
    latched.samples.add_plain(plain_channel);
    latched.add(plain_channel, command_cdr(1, 1));
    latched.add(plain_channel, command_cdr(2, 2));
    latched.add(plain_channel, command_cdr(1, 1));
    THEN("each is there once, the latest last") {
      const mcap::Chunk chunk = latched.samples.chunk_at(9);
      REQUIRE(chunk.message_count() == 2);
      CHECK(dds::topics::beacon_of(message_at(chunk, chunk.entries()[1]).data) == 1);
    }
    WHEN("there are very many") {
      for (std::uint64_t i = 0; i < 1000; ++i) latched.add(plain_channel, command_cdr(3, i));
      THEN("the memory has a limit") {
        CHECK(latched.samples.chunk_at(9).message_count() == 64);
      }
    }
  }
}

}  // namespace sonopose::latched_samples_test
