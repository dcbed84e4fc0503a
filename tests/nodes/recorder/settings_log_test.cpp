#include "recorder/settings_log.hpp"

#include "bus_log/latched_samples.hpp"

#include <catch2/catch.hpp>

#include <cstddef>
#include <initializer_list>
#include <utility>

namespace sonopose::recorder::test::settings_log_test {

using Values = std::initializer_list<std::pair<std::string, std::string>>;

/// Little-endian CDR of effective settings.
std::vector<std::byte> settings_cdr(BeaconAddress address, std::uint64_t from_sequence, Values values) {
  std::vector<std::byte> bytes;
  const auto put = [&bytes](std::uint64_t value, std::size_t size) {
    while (bytes.size() % size != 0) bytes.push_back(std::byte{0});
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  const auto put_text = [&](const std::string& text) {
    put(text.size() + 1, 4);
    for (const char each : text) bytes.push_back(static_cast<std::byte>(each));
    bytes.push_back(std::byte{0});
  };
  put(address, 2);
  put(0, 8);
  put(from_sequence, 8);
  put(values.size(), 4);
  for (const auto& [key, value] : values) {
    put_text(key);
    put_text(value);
  }
  const std::size_t padding = (4 - bytes.size() % 4) % 4;
  bytes.resize(bytes.size() + padding);
  const std::initializer_list<std::byte> header{std::byte{0}, std::byte{1}, std::byte{0},
                                                static_cast<std::byte>(padding)};
  bytes.insert(bytes.begin(), header);
  return bytes;
}

class Chunk {
public:
  Chunk& add(std::uint64_t log_time_ns, BeaconAddress address, Values values) {
    const auto data = settings_cdr(address, 10 * log_time_ns, values);
    chunk_.add({.channel_id = 1,
                .sequence = 1,
                .log_time_ns = log_time_ns,
                .publish_time_ns = log_time_ns,
                .data = data});
    return *this;
  }
  [[nodiscard]] const mcap::Chunk& get() const { return chunk_; }

private:
  mcap::Chunk chunk_;
};

using Texts = std::vector<mcap::TextMap>;

Texts texts(const std::vector<mcap::Metadata>& records) {
  Texts found;
  for (const mcap::Metadata& record : records) found.push_back(record.values);
  return found;
}

TEST_CASE("The settings of a beacon can be told from the records at any time") {
  SettingsLog log(1);
  const Texts first = texts(log.on(Chunk()
                                       .add(1, all_beacons, {{"a", "1"}, {"b", "2"}})
                                       .add(2, 7, {{"a", "1"}, {"b", "2"}})
                                       .add(3, 8, {{"a", "1"}, {"b", "5"}})
                                       .get()));
  CHECK(
      first ==
      Texts{{{"log_time_ns", "1"}, {"from_event_sequence", "10"}, {"a", "1"}, {"b", "2"}},
            {{"log_time_ns", "2"}, {"from_event_sequence", "20"}, {"address", "7"}},
            {{"log_time_ns", "3"}, {"from_event_sequence", "30"}, {"address", "8"}, {"a", "1"}, {"b", "5"}}});

  SECTION("what is written again is no change") {
    CHECK(log.on(Chunk().add(4, 8, {{"a", "1"}, {"b", "5"}}).get()).empty());
  }
  SECTION("a beacon that does not follow a change of all beacons") {
    CHECK(
        texts(log.on(Chunk().add(4, all_beacons, {{"a", "9"}, {"b", "2"}}).get())) ==
        Texts{
            {{"log_time_ns", "4"}, {"from_event_sequence", "40"}, {"a", "9"}, {"b", "2"}},
            {{"log_time_ns", "4"}, {"from_event_sequence", "20"}, {"address", "7"}, {"a", "1"}, {"b", "2"}}});
  }
  SECTION("a beacon that follows it") {
    const Texts found = texts(log.on(
        Chunk().add(4, all_beacons, {{"a", "9"}, {"b", "2"}}).add(5, 7, {{"a", "9"}, {"b", "2"}}).get()));
    REQUIRE(found.size() == 2);
    CHECK(found[1] == mcap::TextMap{{"log_time_ns", "5"}, {"from_event_sequence", "50"}, {"address", "7"}});
  }
}

TEST_CASE("The latest settings begin with those of all beacons") {
  bus_log::LatchedSamples latched({{1, dds::topics::find_topic("settings")}}, 2);
  latched.on(Chunk().add(1, 0, {{"a", "1"}}).add(2, 7, {{"a", "1"}}).add(3, all_beacons, {{"a", "2"}}).get());
  const Texts found = texts(SettingsLog(1).on(latched.chunk_at(9)));
  REQUIRE(found.size() == 3);
  CHECK_FALSE(found[0].contains("address"));
  CHECK(found[1].at("address") == "0");
  CHECK(found[2].at("address") == "7");
}

}  // namespace sonopose::recorder::test::settings_log_test
