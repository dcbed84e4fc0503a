#include "mcap/verify.hpp"

#include "mcap/compression.hpp"
#include "mcap/encoder.hpp"
#include "mcap/memory.hpp"
#include "mcap/record_file.hpp"
#include "mcap/writer.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace verify_test {

using namespace sonopose::mcap;
using Catch::Contains;
using sonopose::test::bytes_of;
using sonopose::test::MemorySink;
using sonopose::test::reader_of;

Bytes file_with_metadata() {
  MemorySink sink;
  Writer writer(sink, {.compression = Compression::none});
  const auto channel = writer.add_channel(writer.add_schema("S", "omgidl", "struct S {};"), "imu", "cdr");
  writer.write({channel, 1, 100, 100, bytes_of("sample")});
  writer.write_metadata({"settings", {{"gain", "0.25"}}});
  writer.close();
  return sink.content;
}

/// An attachment record without a name, with the fields of the specification.
Bytes attachment(std::string_view data, bool is_sound) {
  Bytes record;
  put_record(record, Opcode::attachment, [&] {
    const std::size_t begin = record.size();
    put(record, std::uint64_t{100});  // log_time
    put(record, std::uint64_t{0});    // create_time
    put(record, std::uint32_t{0});    // name
    put(record, std::uint32_t{0});    // media_type
    put(record, std::uint64_t{data.size()});
    put_bytes(record, bytes_of(data));
    put(record, crc32(std::span(record).subspan(begin)) + (is_sound ? 0U : 1U));
  });
  return record;
}

SCENARIO("the data section has a checksum") {
  GIVEN("a file") {
    Bytes file = file_with_metadata();
    THEN("it is sound") {
      CHECK(verify(reader_of(file)).empty());
    }
    WHEN("a byte of its metadata is another one, which nothing else covers") {
      const auto gain = bytes_of("0.25");
      const auto at = std::search(file.begin(), file.end(), gain.begin(), gain.end());
      REQUIRE(at != file.end());
      *at = std::byte{'9'};
      const auto reader = reader_of(file);
      REQUIRE(reader.damages().empty());
      THEN("the checksum does not match") {
        const auto damages = verify(reader);
        REQUIRE(damages.size() == 1);
        CHECK_THAT(damages.front(), Contains("data_section_crc does not match"));
      }
    }
    WHEN("it is cut") {
      file.resize(file.size() / 2);
      THEN("its reader has said so") {
        const auto reader = reader_of(file);
        CHECK_FALSE(reader.damages().empty());
        CHECK(verify(reader).empty());
      }
    }
    WHEN("a length in the data section is wrong, which an index does not show") {
      const auto reader = reader_of(file);
      const auto at = reader.contents().metadata.front().offset;
      file[at + 1] = std::byte{0xFF};
      file[at + 8] = std::byte{0x7F};
      THEN("it is damaged") {
        CHECK_FALSE(verify(reader_of(file)).empty());
      }
    }
    WHEN("its writer has not computed the checksum, and a byte of a chunk is another one") {
      const std::string start_of_data_end("\x0f\x04\0\0\0\0\0\0\0", 9);
      const auto data_end = bytes_of(start_of_data_end);
      const auto at = std::search(file.begin(), file.end(), data_end.begin(), data_end.end());
      REQUIRE(at != file.end());
      std::fill_n(at + 9, 4, std::byte{0});
      REQUIRE(verify(reader_of(file)).empty());
      const auto sample = bytes_of("sample");
      *std::search(file.begin(), file.end(), sample.begin(), sample.end()) = std::byte{'S'};
      THEN("the checksum of the chunk does not match") {
        const auto damages = verify(reader_of(file));
        REQUIRE(damages.size() == 1);
        CHECK_THAT(damages.front(), Contains("uncompressed_crc does not match"));
      }
    }
  }
}

SCENARIO("an attachment has a checksum") {
  const bool is_sound = GENERATE(true, false);
  GIVEN("a file of another program, without an index, with an attachment whose checksum is right or wrong") {
    const Bytes file = file_with_metadata();
    const auto header_end =
        reader_of(file).file().prefix(magic.size(), file.size()).record_length() + magic.size();
    Bytes with_attachment(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(header_end));
    const Bytes record = attachment("picture", is_sound);
    with_attachment.insert(with_attachment.end(), record.begin(), record.end());
    THEN("that is found out") {
      const auto damages = verify(reader_of(with_attachment));
      CHECK(damages.empty() == is_sound);
      if (!is_sound) CHECK_THAT(damages.front(), Contains("Attachment crc does not match"));
    }
    WHEN("there is another one that is too short for a checksum") {
      put_record(with_attachment, Opcode::attachment, [] {});
      THEN("both are looked at") {
        const auto damages = verify(reader_of(with_attachment));
        CHECK(damages.size() == (is_sound ? 1 : 2));
        CHECK_THAT(damages.back(), Contains("Attachment is too short for its crc"));
      }
    }
    WHEN("its name is longer than the record") {
      with_attachment[header_end + record_prefix_bytes + 16] = std::byte{0xff};
      THEN("it is damaged") {
        const auto damages = verify(reader_of(with_attachment));
        REQUIRE(damages.size() == 1);
        CHECK_THAT(damages.front(), Contains("Attachment is too short for its crc"));
      }
    }
  }
}

}  // namespace verify_test
