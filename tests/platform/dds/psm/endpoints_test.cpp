#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>

namespace sonopose::dds::test::endpoints_test {

using Command = sonopose_ResetCommand;

Qos reliable(std::uint32_t depth = 16) {
  return Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(depth);
}

TEST_CASE("A written sample is taken once, with its metadata") {
  GIVEN("a writer and a reader") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<Command> topic(member, "test/write_take");
    sub::DataReader<Command> reader(sub::Subscriber(member), topic, reliable());
    pub::DataWriter<Command> writer(pub::Publisher(member), topic, reliable());
    REQUIRE(matched(reader));

    WHEN("a sample is written with a time stamp of its own") {
      writer.write(command(7, 41), core::Time(1'600'000'000, 1));

      THEN("it is taken with its data, stamp and writer") {
        REQUIRE(wait_for(reader, core::status::StatusMask::data_available(),
                         [&] { return reader.status_changes().test(10); }));
        const sub::LoanedSamples<Command> samples = reader.take();
        REQUIRE(samples.length() == 1);
        const auto& sample = *samples.begin();
        CHECK(sample.data().address == 7);
        CHECK(sample.data().request_id == 41);
        CHECK(sample.info().valid());
        CHECK(ext::is_alive(sample.info()));
        CHECK(ext::source_time_ns(sample.info()) == 1'600'000'000'000'000'001);
        CHECK(sample.info().publication_handle() == writer.instance_handle());
        CHECK_FALSE(sample.info().instance_handle().is_nil());
        CHECK(reader.take().length() == 0);
      }
    }
    WHEN("more samples are there than are asked for") {
      for (std::uint64_t id = 1; id <= 5; ++id) writer.write(command(7, id));
      THEN("the oldest come first and the others stay") {
        std::vector<std::uint64_t> ids;
        for (const auto& sample : reader.select().max_samples(2).take())
          ids.push_back(sample.data().request_id);
        CHECK(ids == std::vector<std::uint64_t>{1, 2});
        CHECK(reader.read().length() == 3);
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
    const domain::DomainParticipant member = participant();
    const topic::Topic<TestType> topic(member, "test/take_each");
    sub::DataReader<TestType> reader(sub::Subscriber(member), topic, reliable(100));
    pub::DataWriter<TestType> writer(pub::Publisher(member), topic, reliable(100));
    REQUIRE(matched(reader));
    for (std::uint64_t number = 1; number <= 70; ++number) writer.write(numbered<TestType>(number));

    WHEN("they are visited") {
      std::vector<std::uint64_t> numbers;
      const std::size_t count = ext::take_each(reader, [&](const TestType& sample, const sub::SampleInfo&) {
        numbers.push_back(number_in(sample));
      });
      THEN("all 70 come, in the order of writing") {
        CHECK(count == 70);
        REQUIRE(numbers.size() == 70);
        for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(numbers[i] == i + 1);
        CHECK(ext::try_take_each(reader, [](const TestType&, const sub::SampleInfo&) {}) == 0);
      }
    }
    WHEN("the visitor throws") {
      CHECK_THROWS_AS(
          ext::take_each(reader, [](const TestType&, const sub::SampleInfo&) { throw std::bad_alloc(); }),
          std::bad_alloc);
      THEN("only its batch is lost") {
        std::vector<std::uint64_t> numbers;
        ext::take_each(reader, [&](const TestType& sample, const sub::SampleInfo&) {
          numbers.push_back(number_in(sample));
        });
        REQUIRE(numbers.size() >= 70 - 32);
        CHECK(numbers.front() == 71 - numbers.size());
        CHECK(numbers.back() == 70);
      }
    }
    WHEN("the reader is gone") {
      reader.close();
      THEN("the error is a code or an exception that names the call") {
        const auto ignore = [](const TestType&, const sub::SampleInfo&) {};
        CHECK(ext::try_take_each(reader, ignore) < 0);
        CHECK_THROWS_WITH(ext::take_each(reader, ignore), Catch::StartsWith("dds_take: "));
        CHECK_THROWS_AS(reader.take(), core::AlreadyClosedError);
      }
    }
  }
}

TEMPLATE_TEST_CASE("Loans of any sizes follow each other", "", Command, sonopose_LogLine) {
  GIVEN("more samples than the largest loan may have") {
    constexpr std::size_t max_loan = 256;
    const domain::DomainParticipant member = participant();
    const topic::Topic<TestType> topic(member, "test/loans");
    sub::DataReader<TestType> reader(sub::Subscriber(member), topic, reliable(1000));
    pub::DataWriter<TestType> writer(pub::Publisher(member), topic, reliable(1000));
    REQUIRE(matched(reader));
    for (std::uint64_t number = 1; number <= 600; ++number) writer.write(numbered<TestType>(number));

    WHEN("a large loan was returned, then all are visited") {
      std::vector<void*> loan(max_loan, nullptr);
      std::vector<dds_sample_info_t> infos(max_loan);
      REQUIRE(dds_take(ext::handle(reader), loan.data(), infos.data(), max_loan, max_loan) == max_loan);
      REQUIRE(dds_return_loan(ext::handle(reader), loan.data(), max_loan) == DDS_RETCODE_OK);
      std::vector<std::uint64_t> numbers;
      ext::take_each(reader, [&](const TestType& sample, const sub::SampleInfo&) {
        numbers.push_back(number_in(sample));
      });
      THEN("none is lost or repeated") {
        REQUIRE(numbers.size() == 600 - max_loan);
        for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(numbers[i] == max_loan + 1 + i);
      }
    }
  }
}

TEST_CASE("The end of an instance is reported") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/instance_end");
  sub::DataReader<Command> reader(sub::Subscriber(member), topic, reliable());
  pub::DataWriter<Command> writer(pub::Publisher(member), topic, reliable());
  REQUIRE(matched(reader));
  writer.write(command(7, 1));
  writer.write(command(8, 1));
  REQUIRE(take_samples(reader, 2).size() == 2);

  std::vector<std::uint16_t> disposed;
  std::vector<std::uint16_t> gone;
  std::size_t data = 0;
  const auto visit = [&] {
    ext::take_each(
        reader, [&](const Command&, const sub::SampleInfo&) { ++data; },
        [&](const Command& key, const sub::SampleInfo& info) {
          if (ext::is_disposed(info)) disposed.push_back(key.address);
          if (!ext::is_alive(info) && !ext::is_disposed(info)) gone.push_back(key.address);
        });
    return !disposed.empty() || !gone.empty();
  };
  SECTION("disposing") {
    CHECK_FALSE(writer.lookup_instance(command(8, 0)).is_nil());
    writer.dispose_instance(command(8, 0));
    REQUIRE(wait_for(reader, core::status::StatusMask::data_available(), visit));
    CHECK(disposed == std::vector<std::uint16_t>{8});
    CHECK(gone.empty());
    CHECK(data == 0);
  }
  SECTION("unregistering, which by default of DDS also disposes") {
    writer.unregister_instance(command(7, 0));
    REQUIRE(wait_for(reader, core::status::StatusMask::data_available(), visit));
    CHECK(disposed == std::vector<std::uint16_t>{7});
    CHECK(writer.lookup_instance(command(7, 0)).is_nil());
  }
}

TEST_CASE("300 keyed instances keep a history each") {
  GIVEN("a reader that keeps the last two samples of an instance") {
    const domain::DomainParticipant member = participant();
    const topic::Topic<sonopose_ImuSample> topic(member, "test/instances");
    sub::DataReader<sonopose_ImuSample> reader(sub::Subscriber(member), topic, reliable(2));
    pub::DataWriter<sonopose_ImuSample> writer(pub::Publisher(member), topic, reliable(2));
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
        std::set<core::InstanceHandle> instances;
        ext::take_each(reader, [&](const sonopose_ImuSample& sample, const sub::SampleInfo& info) {
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
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/matches");
  sub::DataReader<Command> reader(sub::Subscriber(member), topic, reliable());
  std::vector<pub::DataWriter<Command>> writers;
  const pub::Publisher publisher(member);
  for (std::uint8_t i = 0; i < 10; ++i) {
    writers.emplace_back(publisher, topic, reliable() << policy::UserData({'n', i}));
  }
  REQUIRE(matched(reader, 10));

  const std::vector<core::InstanceHandle> publications = ext::matched_publications(reader);
  const std::set<core::InstanceHandle> found(publications.begin(), publications.end());
  std::set<core::InstanceHandle> expected;
  for (const auto& writer : writers) expected.insert(writer.instance_handle());
  CHECK(found == expected);
  CHECK(ext::matched_subscriptions(writers[3]) ==
        std::vector<core::InstanceHandle>{reader.instance_handle()});

  const auto data = ext::matched_publication_data(reader, writers[3].instance_handle());
  REQUIRE(data);
  CHECK(data->user_data == std::vector<std::uint8_t>{'n', 3});
  CHECK_FALSE(ext::matched_publication_data(reader, core::InstanceHandle(12345)));

  writers.pop_back();
  CHECK(matched(reader, 9));
}

TEST_CASE("A transient-local writer serves late joiners") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/late");
  const Qos qos = reliable(1) << policy::Durability::TransientLocal();
  pub::DataWriter<Command> writer(pub::Publisher(member), topic, qos);
  writer.write(command(7, 1));
  writer.write(command(7, 2));
  sub::DataReader<Command> reader(sub::Subscriber(member), topic, qos);
  CHECK_NOTHROW(reader.wait_for_historical_data(ext::to_duration(test_timeout)));
  const std::vector<Command> samples = take_samples(reader, 1);
  REQUIRE(samples.size() == 1);
  CHECK(samples[0].request_id == 2);
  CHECK(ext::wait_for_acknowledgments(writer, test_timeout));
}

TEST_CASE("Errors name the call, its object and the reason") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<Command> topic(member, "test/errors");
  const Qos impossible = Qos() << policy::History::KeepLast(8) << policy::ResourceLimits(8, 8, 4);
  CHECK_THROWS_WITH((pub::DataWriter<Command>(pub::Publisher(member), topic, impossible)),
                    "dds_create_writer(test/errors): Inconsistent Policy");
  CHECK_THROWS_WITH((sub::DataReader<Command>(sub::Subscriber(member), topic, impossible)),
                    "dds_create_reader(test/errors): Inconsistent Policy");
  CHECK_THROWS_AS((topic::Topic<sonopose_ImuSample>(member, "test errors")), core::Exception);
  pub::DataWriter<Command> none = core::null;
  CHECK(ext::try_write(none, command(7, 1)) == DDS_RETCODE_BAD_PARAMETER);
  CHECK_THROWS_AS(none.write(command(7, 1)), core::NullReferenceError);
}

}  // namespace sonopose::dds::test::endpoints_test
