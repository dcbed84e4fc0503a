#include "dds/dds_fixture.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <catch2/catch.hpp>

#include <tuple>

namespace sonopose::dds::test::serialized_topics_test {

using topics::KeyField;

SerializedSample taken_key(SerializedReader& reader, const std::function<void()>& dispose) {
  SerializedSample key;
  dispose();
  wait_for(reader, core::status::StatusMask::data_available(), [&] {
    ext::try_take_each(
        reader, [](SerializedSample&&, const sub::SampleInfo&) {},
        [&](SerializedSample&& end, const sub::SampleInfo&) { key = std::move(end); });
    return !key.bytes().empty();
  });
  return key;
}

TEST_CASE("The table without types has every row of the diagram") {
  CHECK(topics::serialized_topics().size() == std::tuple_size_v<decltype(topics::all)>);
  const auto* const imu = topics::find_topic("imu");
  REQUIRE(imu != nullptr);
  for (const char* const name : {"/imu", "sonopose/imu", "/sonopose/imu"}) {
    CHECK(imu == topics::find_topic(name));
  }
  CHECK(std::string(imu->type_name) == "sonopose::ImuSample");
  CHECK(imu->has_beacon);
  const auto* const line = topics::find_topic("line_status");
  REQUIRE(line != nullptr);
  CHECK_FALSE(line->has_beacon);
  CHECK(topics::find_topic("sonopose/imus") == nullptr);
  const qos::Provider qos = project_qos();
  CHECK_FALSE(imu->is_latched(qos));
  CHECK(topics::find_topic("settings")->is_latched(qos));
  CHECK(topics::find_topic("log")->is_latched(qos));
  CHECK_FALSE(imu->is_exclusive(qos));
  CHECK(topics::find_topic("pose")->is_exclusive(qos));
}

TEST_CASE("Its readers and writers match the typed ones of every topic") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  const auto check = [&](const auto& entry) {
    CAPTURE(entry.name);
    const auto* const topic = topics::find_topic(entry.name);
    REQUIRE(topic != nullptr);
    auto typed_reader = topics::make_reader(member, qos, entry);
    const auto typed_writer = topics::make_writer(member, qos, entry);
    auto reader = topic->make_reader(member, qos, nullptr);
    const auto writer = topic->make_writer(member, qos, topics::Delivery::live);
    CHECK(matched(typed_reader, 2));
    CHECK(wait_for(reader, core::status::StatusMask::subscription_matched(),
                   [&] { return reader.subscription_matched_status().current_count() == 2; }));
  };
  std::apply([&](const auto&... entries) { (check(entries), ...); }, topics::all);
}

TEST_CASE("The key of an instance has its fields by name") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  SECTION("the address of a beacon") {
    auto reader = topics::find_topic("pose")->make_reader(member, qos, nullptr);
    auto writer = topics::make_writer(member, qos, topics::pose);
    sonopose_FusedPose pose{};
    pose.address = 300;
    writer.write(pose);
    const auto key = taken_key(reader, [&] { writer.dispose_instance(pose); });
    CHECK(topics::beacon_of(key.bytes()) == 300);
    CHECK(topics::find_topic("pose")->key_fields(key.bytes()) ==
          std::vector<KeyField>{{"address", std::uint64_t{300}}});
  }
  SECTION("an address and a number") {
    auto reader = topics::find_topic("fusion_status")->make_reader(member, qos, nullptr);
    auto writer = topics::make_writer(member, qos, topics::fusion_status);
    sonopose_FusionStatus status{};
    status.address = 7;
    status.fusion_id = 0x0102030405060708;
    writer.write(status);
    const auto key = taken_key(reader, [&] { writer.dispose_instance(status); });
    CHECK(topics::find_topic("fusion_status")->key_fields(key.bytes()) ==
          std::vector<KeyField>{{"address", std::uint64_t{7}},
                                {"fusion_id", std::uint64_t{0x0102030405060708}}});
  }
  SECTION("a name and a number") {
    auto reader = topics::find_topic("line_status")->make_reader(member, qos, nullptr);
    auto writer = topics::make_writer(member, qos, topics::line_status);
    sonopose_LineStatus line{};
    std::string("/dev/ttyACM0").copy(line.name, sizeof line.name - 1);
    line.bridge_id = 5;
    writer.write(line);
    const auto key = taken_key(reader, [&] { writer.dispose_instance(line); });
    CHECK(topics::find_topic("line_status")->key_fields(key.bytes()) ==
          std::vector<KeyField>{{"name", std::string("/dev/ttyACM0")}, {"bridge_id", std::uint64_t{5}}});
    CHECK(topics::find_topic("line_status")->key_fields(key.bytes().first(8)).empty());
    CHECK(topics::find_topic("line_status")->key_fields({}).empty());
  }
}

TEST_CASE("The times of a sample move, and nothing else") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  auto reader = topics::make_reader(member, qos, topics::line_status);
  auto before = topics::find_topic("line_status")->make_reader(member, qos, nullptr);
  auto writer = topics::make_writer(member, qos, topics::line_status);
  sonopose_LineStatus line{};
  std::string("/dev/ttyACM0").copy(line.name, sizeof line.name - 1);
  line.bridge_id = 5;
  line.time = 1'600'000'000'000'000'001;
  writer.write(line);
  std::vector<std::byte> bytes;
  REQUIRE(wait_for(before, core::status::StatusMask::data_available(), [&] {
    ext::try_take_each(
        before,
        [&](SerializedSample&& sample, const sub::SampleInfo&) {
          bytes.assign(sample.bytes().begin(), sample.bytes().end());
        },
        [](SerializedSample&&, const sub::SampleInfo&) {});
    return !bytes.empty();
  }));
  REQUIRE(take_samples(reader, 1).size() == 1);
  REQUIRE(topics::find_topic("line_status")->shift_times(bytes, -1'000));
  ext::forward(topics::find_topic("line_status")->make_writer(member, qos, topics::Delivery::live), bytes, 1);
  const auto lines = take_samples(reader, 1);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].time == 1'599'999'999'999'999'001);
  CHECK(lines[0].bridge_id == 5);
  CHECK(std::string(lines[0].name) == "/dev/ttyACM0");
  CHECK_FALSE(topics::find_topic("line_status")->shift_times(std::span(bytes).first(10), 1));

  // Topics without a time stay unchanged, and a message keeps its byte order.
  std::vector<std::byte> heading(4 + 24);
  heading[4 + 23] = std::byte{1};  // sonopose/estimate, big-endian: address, fusion_id, time = 1
  topics::find_topic("estimate")->shift_times(heading, 255);
  CHECK(heading[4 + 23] == std::byte{0});
  CHECK(heading[4 + 22] == std::byte{1});
}

}  // namespace sonopose::dds::test::serialized_topics_test
