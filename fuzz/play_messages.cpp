// Reads messages of a recording without their types, like a player and a recorder. Byte 0 selects the topic.
// The other bytes are a sample, a key, and the text of an instance's end.

#include "bus_log/instance_end.hpp"
#include "support.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

void check_sample(const sonopose::dds::topics::SerializedTopic& topic, std::span<const std::byte> bytes) {
  sonopose::dds::topics::beacon_of(bytes);
  sonopose::dds::topics::status_of_pose(bytes);
  sonopose::dds::topics::event_sequence_of(bytes);
  promise(topic.key_fields(bytes).size() <= 2, "a key has at most two fields");
  std::vector<std::byte> moved(bytes.begin(), bytes.end());
  topic.shift_times(moved, 0);
  promise(std::equal(bytes.begin(), bytes.end(), moved.begin(), moved.end()),
          "a shift by nothing changes nothing");
  topic.shift_times(moved, 1'000'000'000);
}

void check_end(std::string_view text) {
  accepts<std::invalid_argument>([&] {
    const auto end = bus_log::instance_end_of(text);
    promise(bus_log::instance_end_of(bus_log::json_of(end)) == end, "what was read is written");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto topics = sonopose::dds::topics::serialized_topics();
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  check_sample(topics[data[0] % topics.size()], bytes);
  check_end({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return 0;
}
