#include "mcap/decompression.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace damage_test {

using namespace sonopose::mcap;
using Catch::Contains;
using sonopose::test::bytes_of;
using sonopose::test::MemorySink;
using sonopose::test::messages_of;
using sonopose::test::OwnMessage;
using sonopose::test::reader_of;

/// Two topics, three chunks of two messages each, and metadata in between.
struct SmallFile {
  Bytes bytes;
  std::vector<OwnMessage> messages;
  std::vector<std::size_t> chunk_ends;  ///< end of each chunk's index
  std::size_t data_end = 0;
};

SmallFile small_file(Compression compression) {
  SmallFile file;
  MemorySink sink;
  Writer writer(sink, {.compression = compression});
  const auto schema = writer.add_schema("S", "omgidl", "struct S {};");
  const auto imu = writer.add_channel(schema, "imu", "cdr");
  const auto fix = writer.add_channel(schema, "fix", "cdr");
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint64_t time_ns = 100 + 10 * i;
    file.messages.push_back({"imu", i, time_ns, time_ns, "sample " + std::to_string(i)});
    file.messages.push_back({"fix", i, time_ns + 1, time_ns, "fix " + std::to_string(i)});
    writer.write({imu, i, time_ns, time_ns, bytes_of(file.messages[file.messages.size() - 2].data)});
    writer.write({fix, i, time_ns + 1, time_ns, bytes_of(file.messages.back().data)});
    writer.end_chunk();
    file.chunk_ends.push_back(sink.content.size());
    writer.write_metadata({"settings", {{"change", std::to_string(i)}}});
  }
  file.data_end = sink.content.size();
  writer.close();
  file.bytes = sink.content;
  return file;
}

/// Size of the message index records of two channels with one message each.
constexpr std::size_t two_indexes = 2U * std::size_t{9 + 2 + 4 + 16};

/// Returns true if `messages` is a subsequence of `all`.
bool are_among(const std::vector<OwnMessage>& messages, const std::vector<OwnMessage>& all) {
  auto next = all.begin();
  for (const OwnMessage& message : messages) {
    next = std::find(next, all.end(), message);
    if (next == all.end()) return false;
    ++next;
  }
  return true;
}

SCENARIO("a file is cut anywhere") {
  const auto compression = GENERATE(Compression::none, Compression::lz4, Compression::zstd);
  const SmallFile file = small_file(compression);
  for (std::size_t size = 0; size < file.bytes.size(); ++size) {
    CAPTURE(name_of(compression), size);
    const auto cut = std::span(file.bytes).first(size);
    const std::size_t header_end = 8 + 9 + 8 + 8;
    if (size < header_end) {
      CHECK_THROWS_AS(reader_of(cut), FormatError);
      continue;
    }
    const auto reader = reader_of(cut);
    const auto messages = messages_of(reader);
    const auto whole_chunks = static_cast<std::size_t>(
        std::ranges::count_if(file.chunk_ends, [size](std::size_t end) { return end <= size; }));
    CHECK_FALSE(reader.damages().empty());
    CHECK(messages.size() >= 2 * whole_chunks);
    CHECK(are_among(messages, file.messages));
    CHECK(reader.statistics().message_count == messages.size());
    if (size >= file.data_end) CHECK(messages == file.messages);
  }
}

TEST_CASE("a chunk that the file ends in gives the messages before the cut") {
  const SmallFile file = small_file(Compression::none);
  // The last chunk's index has 2 x 31 bytes; 5 more bytes cut the last message.
  const auto reader = reader_of(std::span(file.bytes).first(file.chunk_ends[2] - two_indexes - 5));
  CHECK(messages_of(reader).size() == 5);
  CHECK_THAT(reader.damages().at(0), Contains("the file ends in this chunk"));
}

TEST_CASE("one damaged byte is noticed, or does not matter") {
  const auto compression = GENERATE(Compression::none, Compression::lz4, Compression::zstd);
  const SmallFile file = small_file(compression);
  std::size_t noticed = 0;
  for (std::size_t at = 0; at < file.bytes.size(); ++at) {
    for (const auto mask : {std::byte{0x01}, std::byte{0x80}, std::byte{0xff}}) {
      CAPTURE(name_of(compression), at, static_cast<int>(mask));
      Bytes bytes = file.bytes;
      bytes[at] ^= mask;
      try {
        const auto reader = reader_of(bytes);
        const auto messages = messages_of(reader);
        // Schemas and channels precede the chunks, and the summary repeats them under a checksum.
        if (reader.damages().empty()) {
          CHECK(messages == file.messages);
        } else {
          ++noticed;
        }
      } catch (const FormatError&) {
        ++noticed;
      }
    }
  }
  CHECK(noticed > file.bytes.size());
}

TEST_CASE("a damaged chunk stops the messages, or is skipped if asked for") {
  SmallFile file = small_file(Compression::none);
  file.bytes[file.chunk_ends[1] - two_indexes - 1] ^= std::byte{1};  // last byte of the second chunk
  const auto reader = reader_of(file.bytes);
  CHECK_THROWS_WITH(messages_of(reader), Contains("memory.mcap: byte ") &&
                                             Contains("Chunk uncompressed_crc does not match the records"));
  Messages messages(reader, {.damaged = Selection::Damaged::skip});
  std::size_t count = 0;
  while (messages.next()) ++count;
  CHECK(count == 4);
  CHECK(messages.skipped().size() == 1);
}

TEST_CASE("the indexes say how many messages a damaged chunk had, also without a summary") {
  SmallFile file = small_file(Compression::none);
  file.bytes[file.chunk_ends[1] - two_indexes - 1] ^= std::byte{1};  // last byte of the second chunk
  file.bytes.resize(file.data_end);
  SECTION("in a file that was ended without one") {
    put_record(file.bytes, Opcode::data_end, [&] { put(file.bytes, std::uint32_t{0}); });
    put_record(file.bytes, Opcode::footer, [&] { put_bytes(file.bytes, Bytes(8 + 8 + 4)); });
    put_bytes(file.bytes, std::as_bytes(std::span(magic)));
    CHECK_FALSE(reader_of(file.bytes).contents().has_uncounted_loss);
  }
  SECTION("in one that was cut, which may have had more") {
    CHECK(reader_of(file.bytes).contents().has_uncounted_loss);
  }
  const auto reader = reader_of(file.bytes);
  CHECK(reader.statistics().message_count == 4);
  CHECK(reader.contents().lost_messages == 2);
}

/// A file with one metadata record and one chunk, whose summary repeats their index records `metadata` and
/// `chunks` times. Each repetition is shifted by `shift` bytes.
Bytes file_with_repeated_index(std::uint32_t chunks, std::uint32_t metadata, std::uint64_t shift) {
  MemorySink sink;
  Writer writer(sink, {.compression = Compression::none});
  const auto channel = writer.add_channel(0, "t", "json");
  const std::uint64_t metadata_at = sink.content.size();
  writer.write_metadata({"m", {{"a", "b"}}});
  const std::uint64_t chunk_at = sink.content.size();
  writer.write({channel, 1, 5, 5, bytes_of("{}")});
  writer.end_chunk();
  Bytes bytes = sink.content;
  const std::uint64_t chunk_length = bytes.size() - chunk_at - two_indexes / 2;
  put_record(bytes, Opcode::data_end, [&] { put(bytes, std::uint32_t{0}); });
  const std::uint64_t summary_at = bytes.size();
  put_record(bytes, Opcode::channel, [&] {
    put(bytes, channel);
    put(bytes, std::uint16_t{0});
    put_text(bytes, "t");
    put_text(bytes, "json");
    put_map(bytes, {});
  });
  put_record(bytes, Opcode::statistics, [&] {
    put(bytes, std::uint64_t{chunks});
    put(bytes, std::uint16_t{0});
    for (const std::uint32_t count : {1U, 0U, metadata, chunks}) put(bytes, count);
    put_times(bytes, {5, 5});
    put_sized(bytes, [] {});
  });
  for (std::uint32_t i = 0; i < chunks; ++i) {
    put_record(bytes, Opcode::chunk_index, [&] {
      put_times(bytes, {5, 5});
      put(bytes, chunk_at + i * shift);
      put(bytes, chunk_length);
      put_sized(bytes, [] {});
    });
  }
  for (std::uint32_t i = 0; i < metadata; ++i) {
    put_record(bytes, Opcode::metadata_index, [&] {
      put(bytes, metadata_at + i * shift);
      put(bytes, chunk_at - metadata_at);
      put_text(bytes, "m");
    });
  }
  put_record(bytes, Opcode::footer, [&] {
    put(bytes, summary_at);
    put(bytes, std::uint64_t{0});
    put(bytes, std::uint32_t{0});
  });
  put_bytes(bytes, std::as_bytes(std::span(magic)));
  return bytes;
}

SCENARIO("an index names a part of the file twice") {
  GIVEN("an index with each part once") {
    const auto reader = reader_of(file_with_repeated_index(1, 1, 0));
    THEN("it is used") {
      CHECK(reader.damages().empty());
      CHECK(reader.contents().is_indexed);
      CHECK(messages_of(reader).size() == 1);
      CHECK(reader.metadata().size() == 1);
    }
  }
  GIVEN("a chunk or a record of metadata that comes again, as it is or overlapping") {
    const bool is_chunk = GENERATE(true, false);
    const std::uint64_t shift = GENERATE(0U, 1U, 9U);
    CAPTURE(is_chunk, shift);
    const auto reader = reader_of(file_with_repeated_index(is_chunk ? 3 : 1, is_chunk ? 1 : 3, shift));
    THEN("the index is not used, and everything is read once") {
      CHECK_FALSE(reader.contents().is_indexed);
      CHECK_THAT(reader.damages().at(0),
                 Contains("the summary has a record at byte") && Contains("but another one at byte"));
      CHECK(messages_of(reader).size() == 1);
      CHECK(reader.metadata().size() == 1);
    }
  }
}

TEST_CASE("a record that is longer than its index says is refused") {
  SmallFile file = small_file(Compression::none);
  const auto reader = reader_of(file.bytes);
  const Extent metadata = reader.contents().metadata.at(1);
  const Block chunk = reader.contents().blocks.at(1);
  Bytes bytes = file.bytes;
  bytes[metadata.offset + 1] ^= std::byte{1};
  CHECK_THROWS_WITH(reader_of(bytes).metadata(), Contains("but its index says "));
  bytes = file.bytes;
  bytes[chunk.offset + 1] ^= std::byte{1};
  CHECK_THROWS_WITH(messages_of(reader_of(bytes)), Contains("but its index says "));
}

/// A file whose only chunk makes false claims about its size.
Bytes file_with_chunk(std::uint64_t uncompressed_size, std::string_view compression, std::string_view records,
                      std::uint64_t claimed_records) {
  MemorySink sink;
  Writer writer(sink);
  writer.add_channel(0, "t", "json");
  Bytes bytes = sink.content;
  put_record(bytes, Opcode::chunk, [&] {
    put_times(bytes, {1, 2});
    put(bytes, uncompressed_size);
    put(bytes, std::uint32_t{0});
    put_text(bytes, compression);
    put(bytes, claimed_records);
    put_bytes(bytes, bytes_of(records));
  });
  return bytes;
}

TEST_CASE("a chunk that claims too much is refused without the memory that it claims") {
  const std::uint64_t huge = std::uint64_t{1} << 60U;
  const auto damage_of = [](const Bytes& bytes) { return reader_of(bytes).damages().at(0); };
  CHECK_THAT(damage_of(file_with_chunk(huge, "", "x", 1)),
             Contains("Chunk uncompressed_size is 1152921504606846976, the limit is 268435456"));
  CHECK_THAT(damage_of(file_with_chunk(1, "", "x", huge)),
             Contains("Chunk records needs 1152921504606846976 bytes, but only 1 are left in the record"));
  CHECK_THAT(damage_of(file_with_chunk(5, "", "x", 1)),
             Contains("Chunk uncompressed_size is 5, but there are 1 bytes"));
  CHECK_THAT(damage_of(file_with_chunk(5, "rot13", "x", 1)),
             Contains("Chunk compression is \"rot13\"; known: lz4, zstd, none"));
  CHECK_THAT(damage_of(file_with_chunk(5, "zstd", "not zstd", 8)),
             Contains("Chunk records are not a complete"));
  CHECK_THAT(damage_of(file_with_chunk(5, "lz4", "not lz4 at all", 14)),
             Contains("Chunk records are not a complete"));
}

TEST_CASE("a compressed chunk that decompresses to more than it says is refused") {
  const Bytes zeros(1U << 20U);
  for (const Compression compression : {Compression::lz4, Compression::zstd}) {
    Compressor compressor(compression);
    Bytes compressed(compressor.bound(zeros.size()));
    compressed.resize(compressor.compress(zeros, compressed));
    Bytes out;
    CHECK(decompress(compression, compressed, 1000, out) == Decompressed::too_long);
    CHECK(out.size() <= 1001);
    CHECK(decompress(compression, compressed, zeros.size(), out) == Decompressed::complete);
    CHECK(out == zeros);
    CHECK(decompress(compression, std::span(compressed).first(compressed.size() - 1), zeros.size(), out) ==
          Decompressed::cut);
  }
}

TEST_CASE("a message of a channel that is not defined is named and left out, and no other one") {
  MemorySink sink;
  { const Writer writer(sink); }
  Bytes bytes = sink.content;
  bytes.resize(8 + 9 + 8 + 8);
  put_record(bytes, Opcode::channel, [&] {
    put(bytes, std::uint16_t{1});
    put(bytes, no_schema);
    put_text(bytes, "imu");
    put_text(bytes, "cdr");
    put_map(bytes, {});
  });
  for (const auto channel_id : std::vector<std::uint16_t>{1, 7, 1}) {
    put_record(bytes, Opcode::message, [&] {
      put(bytes, channel_id);
      put(bytes, std::uint32_t{1});
      put(bytes, std::uint64_t{channel_id});
      put(bytes, std::uint64_t{1});
    });
  }
  const auto reader = reader_of(bytes);
  CHECK(std::ranges::any_of(reader.damages(), [](const std::string& damage) {
    return damage.find("channel 7 is not defined before; messages of it that are left out: 1") !=
           std::string::npos;
  }));
  CHECK(reader.statistics().message_count == 2);
  Messages messages(reader);
  std::size_t count = 0;
  while (messages.next()) ++count;
  CHECK(count == 2);
}

}  // namespace damage_test
