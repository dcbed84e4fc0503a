#include "dds/dds_fixture.hpp"
#include <sonopose/dds/psm/serialized.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <initializer_list>
#include <optional>

namespace sonopose::dds::test::serialized_test {

using Command = sonopose_ResetCommand;
using Bytes = std::vector<std::byte>;

Qos reliable(std::uint32_t depth = 100) {
  return Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(depth);
}

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

Bytes copy(const SerializedSample& sample) {
  return {sample.bytes().begin(), sample.bytes().end()};
}

// A reset command of beacon 0x0107 with the id 0x1112131415161718 in CDR: header of plain CDR in each byte
// order, address, padding to a multiple of 8 after the header, id.
const Bytes little_endian = bytes_of(
    {0, 1, 0, 0, /**/ 0x07, 0x01, 0, 0, 0, 0, 0, 0, /**/ 0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11});
const Bytes big_endian = bytes_of(
    {0, 0, 0, 0, /**/ 0x01, 0x07, 0, 0, 0, 0, 0, 0, /**/ 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18});
const Command the_command = command(0x0107, 0x1112131415161718);
/// Clears the padding, whose value the specification leaves open.
Bytes without_padding(Bytes bytes) {
  REQUIRE(bytes.size() == little_endian.size());
  std::fill(bytes.begin() + 6, bytes.begin() + 12, std::byte{0});
  return bytes;
}

/// Key of its instance: the address, padded to 4 bytes; the header counts two padding bytes.
const Bytes key_little_endian = bytes_of({0, 1, 0, 2, 0x07, 0x01, 0, 0});
const Bytes key_big_endian = bytes_of({0, 0, 0, 2, 0x01, 0x07, 0, 0});

/// Samples and ends taken by a reader that does not decode.
struct Taken {
  explicit Taken(SerializedReader& from) : reader(from) {}

  /// Takes until there are this many samples and ends.
  bool wait(std::size_t sample_count, std::size_t end_count = 0) {
    return wait_for(reader, core::status::StatusMask::data_available(), [&] {
      take();
      return samples.size() >= sample_count && ends.size() >= end_count;
    });
  }

  void take() {
    const auto count = ext::try_take_each(
        reader,
        [&](SerializedSample&& sample, const sub::SampleInfo& info) {
          stamps_ns.push_back(ext::source_time_ns(info));
          samples.push_back(std::move(sample));
        },
        [&](SerializedSample&& key, const sub::SampleInfo& info) {
          ends.push_back(copy(key));
          samples_before_end.push_back(samples.size());
          end_is_disposal.push_back(ext::is_disposed(info));
        });
    REQUIRE(count >= 0);
  }

  SerializedReader& reader;
  std::vector<SerializedSample> samples;
  std::vector<std::int64_t> stamps_ns;
  std::vector<Bytes> ends;
  std::vector<std::size_t> samples_before_end;
  std::vector<bool> end_is_disposal;
};

/// Address in a key's CDR, in any encoding with this machine's byte order.
int address_in(const Bytes& key) {
  REQUIRE(key.size() >= 6);
  return std::to_integer<int>(key[4]) + 256 * std::to_integer<int>(key[5]);
}

TEST_CASE("Samples arrive as the CDR of the specification") {
  GIVEN("a typed writer and a reader without a decoding") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/serialized_take");
    SerializedReader reader(sub::Subscriber(member), ext::serialized(topic), reliable());
    pub::DataWriter<Command> writer(pub::Publisher(member), topic, reliable());
    REQUIRE(matched(reader));
    Taken taken(reader);

    WHEN("a sample is written") {
      writer.write(the_command, core::Time(1'600'000'000, 1));
      REQUIRE(taken.wait(1));
      THEN("its bytes and its stamp are those of the specification") {
        CHECK(without_padding(copy(taken.samples[0])) == little_endian);
        CHECK(taken.stamps_ns[0] == 1'600'000'000'000'000'001);
        CHECK(address_in(copy(taken.samples[0].key())) == 0x0107);
        CHECK(taken.ends.empty());
      }
      THEN("the bytes outlive the reader, and a moved reference has them") {
        reader.close();
        writer.close();
        const SerializedSample moved(std::move(taken.samples[0]));
        CHECK(without_padding(copy(moved)) == little_endian);
      }
    }
    WHEN("more are written than one batch holds") {
      for (std::uint64_t id = 1; id <= 70; ++id) writer.write(command(7, id));
      THEN("all come, in order") {
        REQUIRE(taken.wait(70));
        REQUIRE(taken.samples.size() == 70);
        for (std::size_t i = 0; i < 70; ++i) {
          CHECK(taken.samples[i].bytes()[12] == static_cast<std::byte>(i + 1));
        }
      }
    }
    WHEN("the visitor throws") {
      for (std::uint64_t id = 1; id <= 3; ++id) writer.write(command(7, id));
      const auto ignore_end = [](SerializedSample&&, const sub::SampleInfo&) {};
      CHECK_THROWS_AS(
          ext::try_take_each(
              reader, [](SerializedSample&&, const sub::SampleInfo&) { throw std::bad_alloc(); }, ignore_end),
          std::bad_alloc);
      THEN("the next samples come") {
        writer.write(command(7, 4));
        REQUIRE(taken.wait(1));
      }
    }
    WHEN("the reader is gone") {
      reader.close();
      const auto ignore = [](SerializedSample&&, const sub::SampleInfo&) {};
      THEN("the error is a code") {
        CHECK(ext::try_take_each(reader, ignore, ignore) < 0);
      }
    }
  }
}

TEST_CASE("The ends of instances arrive with their keys") {
  GIVEN("a reader that has taken two instances") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/serialized_end");
    SerializedReader reader(sub::Subscriber(member), ext::serialized(topic), reliable());
    pub::DataWriter<Command> writer(pub::Publisher(member), topic,
                                    reliable() << policy::WriterDataLifecycle(false));
    REQUIRE(matched(reader));
    Taken taken(reader);
    writer.write(command(7, 1));
    writer.write(command(8, 1));
    REQUIRE(taken.wait(2));

    WHEN("one is disposed of and the other unregistered") {
      writer.dispose_instance(command(8, 0));
      REQUIRE(taken.wait(2, 1));
      writer.unregister_instance(command(7, 0));
      REQUIRE(taken.wait(2, 2));
      THEN("both ends come, each of its kind") {
        CHECK(address_in(taken.ends[0]) == 8);
        CHECK(taken.end_is_disposal[0]);
        CHECK(address_in(taken.ends[1]) == 7);
        CHECK_FALSE(taken.end_is_disposal[1]);
      }
    }
    WHEN("as many samples as a batch holds, or more, and their end come before the reader looks") {
      const std::size_t count = GENERATE(std::size_t{32}, std::size_t{40}, std::size_t{64});
      for (std::size_t id = 1; id <= count; ++id) writer.write(command(8, id));
      writer.dispose_instance(command(8, 0));
      THEN("the end follows the last sample of the instance, once") {
        taken.take();
        CHECK(taken.samples.size() == 2 + count);
        CHECK(taken.samples_before_end == std::vector<std::size_t>{2 + count});
      }
    }
    WHEN("samples and their end come before the reader looks") {
      writer.write(command(8, 2));
      writer.write(command(7, 2));
      writer.write(command(8, 3));
      writer.dispose_instance(command(8, 0));
      THEN("the end follows the last sample of the instance, once") {
        taken.take();
        REQUIRE(taken.samples.size() == 5);
        REQUIRE(taken.ends.size() == 1);
        CHECK(address_in(taken.ends[0]) == 8);
        CHECK(taken.end_is_disposal[0]);
      }
    }
  }
}

TEST_CASE("A forwarded sample arrives equal") {
  GIVEN("a writer of serialized samples and a typed reader") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/serialized_forward");
    sub::DataReader<Command> reader(sub::Subscriber(member), topic, reliable());
    SerializedWriter writer(pub::Publisher(member), ext::serialized(topic),
                            reliable() << policy::WriterDataLifecycle(false));
    REQUIRE(matched(reader));

    const auto bytes = GENERATE(little_endian, big_endian);
    WHEN("bytes of either order are forwarded") {
      ext::forward(writer, bytes, 1'600'000'000'000'000'001);
      REQUIRE(wait_for(reader, core::status::StatusMask::data_available(),
                       [&] { return reader.status_changes().test(10); }));
      THEN("the reader has the sample with its stamp") {
        const auto samples = reader.take();
        REQUIRE(samples.length() == 1);
        CHECK(samples.begin()->data().address == the_command.address);
        CHECK(samples.begin()->data().request_id == the_command.request_id);
        CHECK(ext::source_time_ns(samples.begin()->info()) == 1'600'000'000'000'000'001);
      }
      AND_WHEN("its instance ends") {
        reader.take();
        const auto key = GENERATE(key_little_endian, key_big_endian);
        const bool disposal = GENERATE(true, false);
        ext::forward(writer, key, 1'600'000'000'000'000'002,
                     disposal ? ext::Change::dispose : ext::Change::unregister);
        std::optional<std::uint16_t> ended;
        bool disposed = false;
        REQUIRE(wait_for(reader, core::status::StatusMask::data_available(), [&] {
          ext::take_each(
              reader, [](const Command&, const sub::SampleInfo&) {},
              [&](const Command& end, const sub::SampleInfo& info) {
                ended = end.address;
                disposed = ext::is_disposed(info);
              });
          return ended.has_value();
        }));
        THEN("the reader is told which, and how") {
          CHECK(ended == the_command.address);
          CHECK(disposed == disposal);
        }
      }
    }
    WHEN("the bytes are not of the topic's type") {
      THEN("they are refused") {
        CHECK(ext::try_forward(writer, bytes_of({0, 1, 0}), 1) < 0);
        CHECK(ext::try_forward(writer, bytes_of({0, 1, 0, 0, 7, 1, 0, 0}), 1) < 0);
        CHECK(ext::try_forward(
                  writer, bytes_of({0, 77, 0, 0, 7, 1, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8}), 1) < 0);
        Bytes second_version = little_endian;
        second_version[1] = std::byte{7};
        CHECK(ext::try_forward(writer, second_version, 1) < 0);
        CHECK_THROWS_WITH(ext::forward(writer, {}, 1), Catch::StartsWith("dds_forwardcdr: "));
        CHECK(reader.take().length() == 0);
      }
    }
  }
}

TEST_CASE("What was taken can be forwarded, ends of instances with keys of several fields too") {
  GIVEN("a chain of a typed writer, a reader and a writer without a decoding, and a typed reader") {
    const domain::DomainParticipant member = participant();
    using Line = sonopose_LineStatus;
    const topic::Topic<Line> first(member, "test/serialized_first");
    const topic::Topic<Line> second(member, "test/serialized_second");
    SerializedReader between(sub::Subscriber(member), ext::serialized(first), reliable());
    pub::DataWriter<Line> source(pub::Publisher(member), first, reliable());
    SerializedWriter onward(pub::Publisher(member), ext::serialized(second),
                            reliable() << policy::WriterDataLifecycle(false));
    sub::DataReader<Line> target(sub::Subscriber(member), second, reliable());
    REQUIRE(matched(between));
    REQUIRE(matched(target));
    Taken taken(between);

    WHEN("a sample passes, and its end") {
      Line line{};
      std::string("/dev/ttyACM0").copy(line.name, sizeof line.name - 1);
      line.bridge_id = 0x0102030405060708;
      source.write(line, core::Time(0, 5));
      REQUIRE(taken.wait(1));
      source.dispose_instance(line);
      REQUIRE(taken.wait(1, 1));
      ext::forward(onward, taken.samples[0].bytes(), taken.stamps_ns[0]);
      CHECK(ext::wait_for_acknowledgments(onward, test_timeout));
      std::vector<Line> arrived;
      std::vector<Line> ended;
      const auto take = [&] {
        ext::take_each(
            target, [&](const Line& sample, const sub::SampleInfo&) { arrived.push_back(sample); },
            [&](const Line& key, const sub::SampleInfo&) { ended.push_back(key); });
      };
      REQUIRE(wait_for(target, core::status::StatusMask::data_available(), [&] {
        take();
        return !arrived.empty();
      }));
      ext::forward(onward, taken.ends[0], 6, ext::Change::dispose);
      REQUIRE(wait_for(target, core::status::StatusMask::data_available(), [&] {
        take();
        return !ended.empty();
      }));
      THEN("both arrive with their key") {
        CHECK(std::string(arrived[0].name) == "/dev/ttyACM0");
        CHECK(arrived[0].bridge_id == line.bridge_id);
        CHECK(std::string(ended[0].name) == "/dev/ttyACM0");
        CHECK(ended[0].bridge_id == line.bridge_id);
      }
    }
  }
}

}  // namespace sonopose::dds::test::serialized_test
