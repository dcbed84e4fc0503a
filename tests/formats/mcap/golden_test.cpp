/// Files written byte by byte from the specification (https://mcap.dev/spec). Checksums are zlib's CRC-32,
/// whose check value for "123456789" is cbf43926.

#include "mcap/compression.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"

#include <catch2/catch.hpp>

namespace golden_test {

using namespace sonopose::mcap;
using sonopose::test::bytes_of;
using sonopose::test::MemorySink;
using sonopose::test::messages_of;
using sonopose::test::OwnMessage;
using sonopose::test::reader_of;

Bytes from_hex(std::string_view text) {
  Bytes bytes;
  std::string digits;
  for (const char c : text) {
    if (c == ' ') continue;
    digits += c;
    if (digits.size() < 2) continue;
    bytes.push_back(static_cast<std::byte>(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return bytes;
}

const std::string magic_hex = "89 4d434150 30 0d0a ";
const std::string header_hex = "01 0b00000000000000 00000000 03000000 6c6962 ";  // "", "lib"
const std::string schema_hex =                                                   // 1, "S", "omgidl", "x"
    "03 1600000000000000 0100 01000000 53 06000000 6f6d6769646c 01000000 78 ";
const std::string channel_hex =  // 1, schema 1, "t", "cdr", 10 bytes of map: "k" "v"
    "04 1e00000000000000 0100 0100 01000000 74 03000000 636472 0a000000 01000000 6b 01000000 76 ";
const std::string messages_hex =  // channel 1, sequence, log time, publish time, data
    "05 1b00000000000000 0100 07000000 6400000000000000 5a00000000000000 00010000aa "
    "05 1b00000000000000 0100 08000000 c800000000000000 be00000000000000 00010000bb ";

const std::string chunked_file =
    magic_hex + header_hex + schema_hex + channel_hex +
    // At byte 98: times 100 to 200, 72 bytes, their CRC, no compression, 72 bytes.
    "06 7000000000000000 6400000000000000 c800000000000000 4800000000000000 dfeb1d4d 00000000 "
    "4800000000000000 " +
    messages_hex +
    // At byte 219: channel 1, 32 bytes of (100, 0), (200, 36).
    "07 2600000000000000 0100 20000000 6400000000000000 0000000000000000 c800000000000000 2400000000000000 "
    // At byte 266: "m", 10 bytes of map: "a" "b".
    "0c 1300000000000000 01000000 6d 0a000000 01000000 61 01000000 62 "
    // CRC of all bytes before.
    "0f 0400000000000000 9d2210c6 " +
    // The summary, from byte 307.
    schema_hex + channel_hex +
    // 2 messages, 1 schema, 1 channel, 0 attachments, 1 metadata, 1 chunk, from 100 to 200, channel 1: 2.
    "0b 3800000000000000 0200000000000000 0100 01000000 00000000 01000000 01000000 6400000000000000 "
    "c800000000000000 0a000000 0100 0200000000000000 "
    // 100 to 200, chunk at 98 of 121 bytes, channel 1's index at 219, 47 bytes of index, no compression,
    // 72, 72.
    "08 4a00000000000000 6400000000000000 c800000000000000 6200000000000000 7900000000000000 "
    "0a000000 0100 db00000000000000 2f00000000000000 00000000 4800000000000000 4800000000000000 "
    // Metadata at 266 of 28 bytes, "m".
    "0d 1500000000000000 0a01000000000000 1c00000000000000 01000000 6d "
    // Groups of the summary: opcode, start, length.
    "0e 1100000000000000 03 3301000000000000 1f00000000000000 "
    "0e 1100000000000000 04 5201000000000000 2700000000000000 "
    "0e 1100000000000000 0b 7901000000000000 4100000000000000 "
    "0e 1100000000000000 08 ba01000000000000 5300000000000000 "
    "0e 1100000000000000 0d 0d02000000000000 1e00000000000000 "
    // Summary from 307, offsets from 555, CRC from 307 to here.
    "02 1400000000000000 3301000000000000 2b02000000000000 34632c82 " +
    magic_hex;

const std::vector<OwnMessage> two_messages{{"t", 7, 100, 90, std::string("\0\1\0\0\xaa", 5)},
                                           {"t", 8, 200, 190, std::string("\0\1\0\0\xbb", 5)}};

TEST_CASE("the checksum is the CRC-32 of zlib") {
  CHECK(crc32(bytes_of("123456789")) == 0xcbf43926);
  CHECK(crc32(bytes_of("6789"), crc32(bytes_of("12345"))) == 0xcbf43926);
}

SCENARIO("a file has the bytes that the specification says") {
  GIVEN("a writer without compression") {
    MemorySink sink;
    Writer writer(sink, {.library = "lib", .compression = Compression::none});
    WHEN("a schema, a channel, two messages in two pieces each, and metadata are written") {
      const auto channel =
          writer.add_channel(writer.add_schema("S", "omgidl", "x"), "t", "cdr", {{"k", "v"}});
      const auto head = from_hex("00010000");
      writer.write({channel, 7, 100, 90, from_hex("aa")}, head);
      writer.write({channel, 8, 200, 190, from_hex("bb")}, head);
      writer.end_chunk();
      writer.write_metadata({"m", {{"a", "b"}}});
      const std::uint64_t closing_bytes = writer.closing_bytes();
      const std::uint64_t before = writer.bytes_written();
      writer.close();
      THEN("each byte is as worked out by hand") {
        CHECK(sink.content == from_hex(chunked_file));
        CHECK(writer.bytes_written() == sink.content.size());
      }
      THEN("the bytes of closing were known before") {
        CHECK(writer.bytes_written() - before == closing_bytes);
      }
    }
  }
}

SCENARIO("a file that was written by hand is read") {
  GIVEN("a file with a chunk and an index") {
    const auto reader = reader_of(from_hex(chunked_file));
    THEN("its contents are those of the summary") {
      CHECK(reader.damages().empty());
      CHECK(reader.contents().is_indexed);
      CHECK(reader.contents().library == "lib");
      CHECK(reader.schemas().at(1) == Schema{1, "S", "omgidl", "x"});
      CHECK(reader.channels().at(1) == Channel{1, 1, "t", "cdr", {{"k", "v"}}});
      CHECK(reader.statistics().message_count == 2);
      CHECK(reader.statistics().log_times == TimeSpan{100, 200});
      CHECK(reader.metadata() == std::vector<Metadata>{{"m", {{"a", "b"}}}});
      CHECK(messages_of(reader) == two_messages);
    }
  }
  GIVEN("the smallest file: a header and a footer") {
    const auto reader =
        reader_of(from_hex(magic_hex + header_hex +
                           "02 1400000000000000 0000000000000000 0000000000000000 00000000 " + magic_hex));
    THEN("it is sound and empty") {
      CHECK(reader.damages().empty());
      CHECK(messages_of(reader).empty());
    }
  }
  GIVEN("a file with messages outside of chunks and no summary") {
    const auto reader = reader_of(from_hex(magic_hex + header_hex + schema_hex + channel_hex + messages_hex +
                                           "0f 0400000000000000 00000000 "
                                           "02 1400000000000000 0000000000000000 0000000000000000 00000000 " +
                                           magic_hex));
    THEN("they are found, and counted") {
      CHECK(reader.damages().empty());
      CHECK_FALSE(reader.contents().is_indexed);
      CHECK(messages_of(reader) == two_messages);
      CHECK(reader.statistics().message_count == 2);
      CHECK(reader.statistics().channel_message_counts == std::map<std::uint16_t, std::uint64_t>{{1, 2}});
    }
  }
  GIVEN("a file with records and fields of a later version of the format") {
    const std::string longer_channel =
        "04 1f00000000000000 0100 0100 01000000 74 03000000 636472 0a000000 01000000 6b 01000000 76 ff ";
    const auto reader = reader_of(from_hex(magic_hex + header_hex + "80 0100000000000000 00 " + schema_hex +
                                           longer_channel + messages_hex +
                                           "7f 0000000000000000 0f 0400000000000000 00000000 "
                                           "02 1400000000000000 0000000000000000 0000000000000000 00000000 " +
                                           magic_hex));
    THEN("they are ignored") {
      CHECK(reader.damages().empty());
      CHECK(messages_of(reader) == two_messages);
    }
  }
}

}  // namespace golden_test
