#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>

namespace sonopose::dds::test::endpoints_test {

using Command = sonopose_ResetCommand;

Qos reliable(std::int32_t depth = 16) {
  return Qos() << policy::Reliability::reliable() << policy::History::keep_last(depth);
}

TEST_CASE("A written sample is taken once, with its metadata") {
  GIVEN("a writer and a reader") {
    const DomainParticipant member = participant();
    const Topic<Command> topic(member, "test/write_take");
    DataReader<Command> reader(member, topic, reliable());
    DataWriter<Command> writer(member, topic, reliable());
    REQUIRE(matched(reader));

    WHEN("a sample is written with a time stamp of its own") {
      writer.write(command(7, 41), 1'600'000'000'000'000'001);

      THEN("it is taken with its data, stamp and writer") {
        REQUIRE(wait_for(reader, StatusMask::data_available(),
                         [&] { return reader.status_changes().test(StatusMask::data_available()); }));
        {
          const LoanedSamples<Command> samples = reader.take();
          REQUIRE(samples.size() == 1);
          CHECK(samples[0].data().address == 7);
          CHECK(samples[0].data().request_id == 41);
          CHECK(samples[0].info().valid());
          CHECK(samples[0].info().alive());
          CHECK(samples[0].info().new_instance());
          CHECK_FALSE(samples[0].info().read_before());
          CHECK(samples[0].info().source_timestamp_ns() == 1'600'000'000'000'000'001);
          CHECK(samples[0].info().publication_handle() == writer.instance_handle());
          CHECK_FALSE(samples[0].info().instance_handle().is_nil());
        }
        CHECK(reader.take().empty());
      }
    }
    WHEN("more samples are there than are asked for") {
      for (std::uint64_t id = 1; id <= 5; ++id) writer.write(command(7, id));
      THEN("the oldest come first and the others stay") {
        std::vector<std::uint64_t> ids;
        for (const auto& sample : reader.take(2)) ids.push_back(sample.data().request_id);
        CHECK(ids == std::vector<std::uint64_t>{1, 2});
        const LoanedSamples<Command> rest = reader.read();
        CHECK(rest.size() == 3);
        CHECK_FALSE(rest[0].info().new_instance());
        CHECK(reader.take()[2].info().read_before());
      }
    }
  }
}

/// Number in a sample of a fixed-size type, or of one with strings, which take_each handles differently.
auto& number_in(auto& sample) {
  if constexpr (requires { sample.request_id; }) {
    return sample.request_id;
  } else {
    return sample.number;
  }
}

template <class T>
T numbered(std::uint64_t number) {
  T sample{};
  number_in(sample) = number;
  return sample;
}

TEMPLATE_TEST_CASE("take_each passes all samples in order, however many there are", "", Command,
                   sonopose_LogLine) {
  GIVEN("more samples than one batch has") {
    const DomainParticipant member = participant();
    const Topic<TestType> topic(member, "test/take_each");
    DataReader<TestType> reader(member, topic, reliable(100));
    DataWriter<TestType> writer(member, topic, reliable(100));
    REQUIRE(matched(reader));
    for (std::uint64_t number = 1; number <= 70; ++number) writer.write(numbered<TestType>(number));

    WHEN("they are visited") {
      std::vector<std::uint64_t> numbers;
      const std::size_t count = reader.take_each(
          [&](const TestType& sample, const SampleInfo&) { numbers.push_back(number_in(sample)); });
      THEN("all 70 come, in the order of writing") {
        CHECK(count == 70);
        REQUIRE(numbers.size() == 70);
        for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(numbers[i] == i + 1);
        CHECK(reader.try_take_each([](const TestType&, const SampleInfo&) {}) == 0);
      }
    }
    WHEN("the visitor throws") {
      CHECK_THROWS_AS(reader.take_each([](const TestType&, const SampleInfo&) { throw std::bad_alloc(); }),
                      std::bad_alloc);
      THEN("only its batch is lost") {
        std::vector<std::uint64_t> numbers;
        reader.take_each(
            [&](const TestType& sample, const SampleInfo&) { numbers.push_back(number_in(sample)); });
        REQUIRE(numbers.size() >= 70 - 32);
        CHECK(numbers.front() == 71 - numbers.size());
        CHECK(numbers.back() == 70);
      }
    }
    WHEN("the reader is gone") {
      reader.close();
      THEN("the error is a code or an exception that names the call") {
        const auto ignore = [](const TestType&, const SampleInfo&) {};
        CHECK(reader.try_take_each(ignore) < 0);
        CHECK_THROWS_WITH(reader.take_each(ignore), Catch::StartsWith("dds_take: "));
        CHECK_THROWS_AS(reader.take(), Error);
      }
    }
  }
}

// Cyclone DDS writes a pointer for each sample of a reader's largest loan, even into the array of a smaller
// one.
TEMPLATE_TEST_CASE("Loans of any sizes follow each other", "", Command, sonopose_LogLine) {
  GIVEN("a reader that had a loan of the largest size") {
    const DomainParticipant member = participant();
    const Topic<TestType> topic(member, "test/loan_sizes");
    DataReader<TestType> reader(member, topic, reliable(1000));
    DataWriter<TestType> writer(member, topic, reliable(1000));
    REQUIRE(matched(reader));
    for (std::uint64_t number = 1; number <= 600; ++number) writer.write(numbered<TestType>(number));
    REQUIRE(reader.take(10'000).size() == max_loan);

    WHEN("one sample is asked for, then all are visited") {
      std::vector<std::uint64_t> numbers;
      for (const auto& sample : reader.take(1)) numbers.push_back(number_in(sample.data()));
      reader.take_each(
          [&](const TestType& sample, const SampleInfo&) { numbers.push_back(number_in(sample)); });
      THEN("none is lost or repeated") {
        REQUIRE(numbers.size() == 600 - max_loan);
        for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(numbers[i] == max_loan + 1 + i);
      }
    }
  }
}

TEST_CASE("The end of an instance is reported") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/instance_end");
  DataReader<Command> reader(member, topic, reliable());
  DataWriter<Command> writer(member, topic, reliable());
  REQUIRE(matched(reader));
  writer.write(command(7, 1));
  writer.write(command(8, 1));
  REQUIRE(take_samples(reader, 2).size() == 2);

  std::vector<std::uint16_t> disposed;
  std::vector<std::uint16_t> gone;
  std::size_t data = 0;
  const auto visit = [&] {
    reader.take_each([&](const Command&, const SampleInfo&) { ++data; },
                     [&](const Command& key, const SampleInfo& info) {
                       if (info.disposed()) disposed.push_back(key.address);
                       if (info.no_writers()) gone.push_back(key.address);
                     });
    return !disposed.empty() || !gone.empty();
  };
  SECTION("disposing") {
    CHECK_FALSE(writer.lookup_instance(command(8, 0)).is_nil());
    writer.dispose_instance(command(8, 0));
    REQUIRE(wait_for(reader, StatusMask::data_available(), visit));
    CHECK(disposed == std::vector<std::uint16_t>{8});
    CHECK(gone.empty());
    CHECK(data == 0);
  }
  SECTION("unregistering, which by default of DDS also disposes") {
    writer.unregister_instance(command(7, 0));
    REQUIRE(wait_for(reader, StatusMask::data_available(), visit));
    CHECK(disposed == std::vector<std::uint16_t>{7});
    CHECK(writer.lookup_instance(command(7, 0)).is_nil());
  }
}

TEST_CASE("300 keyed instances keep a history each") {
  GIVEN("a reader that keeps the last two samples of an instance") {
    const DomainParticipant member = participant();
    const Topic<sonopose_ImuSample> topic(member, "test/instances");
    DataReader<sonopose_ImuSample> reader(member, topic, reliable(2));
    DataWriter<sonopose_ImuSample> writer(member, topic, reliable(2));
    REQUIRE(matched(reader));

    WHEN("300 beacons write three samples each") {
      for (std::uint64_t sequence = 1; sequence <= 3; ++sequence) {
        for (std::uint16_t address = 0; address < 300; ++address) {
          sonopose_ImuSample imu{};
          imu.address = address;
          imu.event_sequence = sequence;
          writer.write(imu);
        }
      }
      THEN("the last two of each are there and no instance has pushed another one out") {
        std::map<std::uint16_t, std::vector<std::uint64_t>> sequences;
        std::set<InstanceHandle> instances;
        reader.take_each([&](const sonopose_ImuSample& sample, const SampleInfo& info) {
          sequences[sample.address].push_back(sample.event_sequence);
          instances.insert(info.instance_handle());
        });
        REQUIRE(sequences.size() == 300);
        CHECK(instances.size() == 300);
        for (const auto& [address, of_beacon] : sequences) {
          CHECK(of_beacon == std::vector<std::uint64_t>{2, 3});
        }
      }
    }
  }
}

TEST_CASE("Reader and writer know their matched endpoints") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/matches");
  DataReader<Command> reader(member, topic, reliable());
  std::vector<DataWriter<Command>> writers;
  for (std::uint8_t i = 0; i < 10; ++i) {
    writers.emplace_back(member, topic, reliable() << policy::UserData{{'n', i}});
  }
  REQUIRE(matched(reader, 10));

  const std::vector<InstanceHandle> publications = reader.matched_publications();
  const std::set<InstanceHandle> found(publications.begin(), publications.end());
  std::set<InstanceHandle> expected;
  for (const auto& writer : writers) expected.insert(writer.instance_handle());
  CHECK(found == expected);
  CHECK(writers[3].matched_subscriptions() == std::vector<InstanceHandle>{reader.instance_handle()});

  const PublicationData data = reader.matched_publication_data(writers[3].instance_handle());
  CHECK(data.topic_name == "test/matches");
  CHECK(data.type_name == "sonopose::ResetCommand");
  CHECK(data.user_data == std::vector<std::uint8_t>{'n', 3});
  CHECK_THROWS_AS(reader.matched_publication_data(InstanceHandle{12345}), Error);

  writers.pop_back();
  CHECK(matched(reader, 9));
}

TEST_CASE("A transient-local writer serves late joiners") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/late");
  const Qos qos = reliable(1) << policy::Durability{policy::DurabilityKind::transient_local};
  DataWriter<Command> writer(member, topic, qos);
  writer.write(command(7, 1));
  writer.write(command(7, 2));
  DataReader<Command> reader(member, topic, qos);
  CHECK(reader.wait_for_historical_data(test_timeout));
  const std::vector<Command> samples = take_samples(reader, 1);
  REQUIRE(samples.size() == 1);
  CHECK(samples[0].request_id == 2);
  CHECK(writer.wait_for_acknowledgments(test_timeout));
}

TEST_CASE("Errors name the call, its object and the reason") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/errors");
  const Qos impossible = Qos() << policy::History::keep_last(8) << policy::ResourceLimits{8, 8, 4};
  CHECK_THROWS_WITH((DataWriter<Command>(member, topic, impossible)),
                    "dds_create_writer(test/errors): Inconsistent Policy");
  CHECK_THROWS_WITH((DataReader<Command>(member, topic, impossible)),
                    "dds_create_reader(test/errors): Inconsistent Policy");
  CHECK_THROWS_AS((Topic<sonopose_ImuSample>(member, "test errors")), Error);
  DataWriter<Command> none;
  CHECK(none.try_write(command(7, 1)) == DDS_RETCODE_BAD_PARAMETER);
  try {
    none.write(command(7, 1));
    FAIL("a write by no writer went through");
  } catch (const Error& error) {
    CHECK(error.code() == DDS_RETCODE_BAD_PARAMETER);
  }
}

}  // namespace sonopose::dds::test::endpoints_test
