#include "dds/dds_fixture.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace sonopose::dds::test::topics_test {

/// The key, or its first part.
auto& key_of(auto& sample) {
  if constexpr (requires { sample.address; }) {
    return sample.address;
  } else if constexpr (requires { sample.bridge_id; }) {
    return sample.bridge_id;
  } else {
    return sample.process_id;
  }
}

/// Sends one sample of the topic from a new writer to a new reader.
template <class T>
void check_pair(const domain::DomainParticipant& member, const qos::Provider& qos,
                const topics::Entry<T>& entry, topics::Delivery written, topics::Delivery read) {
  CAPTURE(entry.name, written, read);
  sub::DataReader<T> reader = topics::make_reader(member, qos, entry, nullptr, read);
  pub::DataWriter<T> writer = topics::make_writer(member, qos, entry, nullptr, written);
  REQUIRE(matched(reader));
  T sample{};
  key_of(sample) = 7;
  writer.write(sample);
  T taken = take_samples(reader, 1).at(0);
  CHECK(key_of(taken) == 7);
  CHECK(reader.requested_incompatible_qos_status().total_count() == 0);
  CHECK(writer.offered_incompatible_qos_status().total_count() == 0);
  writer.unregister_instance(sample);
}

TEST_CASE("Every row of the wiring diagram carries samples, live and lossless in any mixture") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  std::apply(
      [&](const auto&... entry) {
        for (const topics::Delivery written : {topics::Delivery::live, topics::Delivery::lossless}) {
          for (const topics::Delivery read : {topics::Delivery::live, topics::Delivery::lossless}) {
            (check_pair(member, qos, entry, written, read), ...);
          }
        }
      },
      topics::all);
}

TEST_CASE("Every row has a unique name below sonopose") {
  std::set<std::string> names;
  std::apply([&](const auto&... entry) { (names.insert(entry.name), ...); }, topics::all);
  CHECK(names.size() == std::tuple_size_v<decltype(topics::all)>);
  for (const std::string& name : names) CHECK_THAT(name, Catch::StartsWith("sonopose/"));
}

TEST_CASE("A status reaches a late-joining monitor") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  pub::DataWriter<sonopose_FusionStatus> writer = topics::make_writer(member, qos, topics::fusion_status);
  sonopose_FusionStatus status{};
  status.address = 9;
  status.time = 1;
  writer.write(status);
  status.time = 2;
  writer.write(status);
  sub::DataReader<sonopose_FusionStatus> late = topics::make_reader(member, qos, topics::fusion_status);
  const auto samples = take_samples(late, 1);
  REQUIRE(samples.size() == 1);
  CHECK(samples[0].time == 2);
}

/// Counts the losses that DDS reports.
struct LossListener final : sub::NoOpDataReaderListener<sonopose_FusedPose> {
  void on_sample_lost(sub::DataReader<sonopose_FusedPose>& /*reader*/,
                      const core::status::SampleLostStatus& status) noexcept override {
    lost += status.total_count_change();
  }
  std::int32_t lost = 0;
};

TEST_CASE("What a standby writes is no loss of its consumers") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  const auto writer_of = [&](std::int32_t strength) {
    return topics::make_writer(member, qos, topics::pose, nullptr, topics::Delivery::live,
                               Qos() << policy::OwnershipStrength(strength));
  };
  LossListener listener;
  auto reader = topics::make_reader(member, qos, topics::pose, &listener, topics::Delivery::live,
                                    static_cast<topics::AddressFilter*>(nullptr),
                                    ext::all_but(core::status::StatusMask::data_available()));
  auto serving = writer_of(200);
  auto standby = writer_of(100);
  REQUIRE(matched(reader, 2));
  sonopose_FusedPose pose{};
  pose.address = 7;
  for (std::uint64_t event = 1; event <= 10; ++event) {  // within a process, a write delivers the sample
    pose.event_sequence = event;
    serving.write(pose);
    standby.write(pose);
  }
  CHECK(take_samples(reader, 10).size() == 10);
  CHECK(listener.lost == 0);
}

TEST_CASE("A reset does not reach a late-joining fusion") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  pub::DataWriter<sonopose_ResetCommand> writer = topics::make_writer(member, qos, topics::reset);
  writer.write(command(7, 1));
  sub::DataReader<sonopose_ResetCommand> late = topics::make_reader(member, qos, topics::reset);
  REQUIRE(matched(late));
  writer.write(command(7, 2));
  const auto samples = take_samples(late, 1);
  REQUIRE(samples.size() == 1);
  CHECK(samples[0].request_id == 2);
}

TEST_CASE(
    "The effective settings reach a late-joining consumer: the latest of each beacon, with their texts") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  auto writer = topics::make_writer(member, qos, topics::settings);
  const EffectiveSettings first{7, 1, 10, {{"documented.drift.jump_alpha", "0.25"}}};
  const EffectiveSettings second{
      7, 2, 20, {{"documented.drift.jump_alpha", "0.5"}, {"documented.imu_weight", "user"}}};
  const EffectiveSettings other{8, 3, 1, {}};
  for (const auto* settings : {&first, &second, &other}) writer.write(topics::to_idl(*settings).sample());
  auto late = topics::make_reader(member, qos, topics::settings);
  std::vector<EffectiveSettings> seen;
  REQUIRE(wait_for(late, core::status::StatusMask::data_available(), [&] {
    ext::take_each(
        late, [&](const auto& sample, const sub::SampleInfo&) { seen.push_back(topics::from_idl(sample)); });
    return seen.size() >= 2;
  }));
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.address < b.address; });
  CHECK(seen == std::vector<EffectiveSettings>{second, other});
}

TEST_CASE("A settings request does not reach a late-joining fusion, and many in a row all arrive") {
  const domain::DomainParticipant member = participant();
  const qos::Provider qos = project_qos();
  auto writer = topics::make_writer(member, qos, topics::settings_request);
  const auto request = [](std::uint64_t id) {
    return SettingsRequest{all_beacons, id, 0, {{"documented.trust.n_base", std::to_string(id)}}};
  };
  writer.write(topics::to_idl(request(100)).sample());
  auto late = topics::make_reader(member, qos, topics::settings_request);
  REQUIRE(matched(late));
  std::vector<SettingsRequest> expected;
  for (std::uint64_t id = 1; id <= 64; ++id) {
    expected.push_back(request(id));
    writer.write(topics::to_idl(expected.back()).sample());
  }
  std::vector<SettingsRequest> seen;
  wait_for(late, core::status::StatusMask::data_available(), [&] {
    ext::take_each(
        late, [&](const auto& sample, const sub::SampleInfo&) { seen.push_back(topics::from_idl(sample)); });
    return seen.size() >= expected.size();
  });
  CHECK(seen == expected);
}

}  // namespace sonopose::dds::test::topics_test
