// Reads an MCAP file of any content: its metadata, its messages in both orders and as JSON, and the samples
// of a beacon for a replay.

#include "bus_log/messages.hpp"
#include "bus_log/outputs.hpp"
#include "bus_log/sensor_log.hpp"
#include "bus_log/summary.hpp"
#include "mcap/omg_idl.hpp"
#include "mcap/reader.hpp"
#include "mcap/verify.hpp"
#include "sensor_logs.hpp"
#include "support.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

volatile std::byte seen;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

class InputSource final : public mcap::ByteSource {
public:
  explicit InputSource(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] const std::string& name() const override {
    static const std::string name = "input.mcap";
    return name;
  }
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> to) const override {
    promise(offset <= bytes_.size() && to.size() <= bytes_.size() - offset,
            "only bytes of the file are read");
    std::copy_n(bytes_.data() + offset, to.size(), to.data());
  }

private:
  std::span<const std::byte> bytes_;
};

std::uint64_t count_messages(const mcap::Reader& reader, mcap::Selection::Order order) {
  mcap::Messages messages(reader, {{}, 0, UINT64_MAX, order, mcap::Selection::Damaged::skip});
  bus_log::MessageLines lines(reader);
  std::uint64_t count = 0;
  std::uint64_t last_ns = 0;
  while (const auto message = messages.next()) {
    promise(reader.channels().contains(message->channel_id), "a message has a channel");
    // Otherwise the order is that of the indexes, which may be wrong.
    const bool is_by_time = order == mcap::Selection::Order::log_time && !reader.contents().is_indexed;
    promise(!is_by_time || message->log_time_ns >= last_ns, "messages are in the order of time");
    last_ns = message->log_time_ns;
    for (const std::byte byte : message->data) seen = byte;  // checks that all data can be read
    const mcap::Channel& channel = reader.channels().at(message->channel_id);
    promise(lines.line_of(channel, *message).find('\n') == std::string::npos,
            "a message as JSON is one line");
    std::ignore = bus_log::beacon_of(channel, *message);
    ++count;
  }
  return count;
}

/// Checks limits that a small file reaches, without skipping damage.
void check_limits(const mcap::Reader& reader) {
  for (const std::uint64_t max_bytes : {std::uint64_t{200}, mcap::Selection{}.max_bytes}) {
    accepts<mcap::FormatError>([&] {
      mcap::Selection selection;
      selection.start_ns = 90;
      selection.end_ns = 1'700'000'000'005'000'000;
      selection.max_bytes = max_bytes;
      mcap::Messages messages(reader, selection);
      while (const auto message = messages.next()) {
        promise(message->log_time_ns >= selection.start_ns && message->log_time_ns <= selection.end_ns,
                "a message is in the span of time");
      }
      promise(messages.skipped().empty(), "where damage is refused, nothing is skipped");
    });
  }
}

void check(const mcap::Reader& reader) {
  for (const auto& [id, channel] : reader.channels()) promise(id == channel.id, "a channel has its id");
  const std::uint64_t by_time = count_messages(reader, mcap::Selection::Order::log_time);
  promise(count_messages(reader, mcap::Selection::Order::file) == by_time,
          "both orders have the same messages");
  const bool was_scanned = !reader.contents().is_indexed;
  promise(!was_scanned || by_time == reader.statistics().message_count, "a scan counts the messages");
  accepts<mcap::FormatError>([&] { std::ignore = reader.metadata(); });
  std::vector<std::string> damages;
  promise(reader.metadata(damages).size() <= reader.contents().metadata.size(),
          "a record of metadata comes once");
  std::ignore = mcap::verify(reader);
  for (const auto& [id, schema] : reader.schemas())
    std::ignore = mcap::definition_in(schema.data, schema.name);
  promise(bus_log::summary_json(reader).find('\n') == std::string::npos, "a summary as JSON is one line");
}

constexpr BeaconAddress address = 7;

void check_outputs(const mcap::Reader& reader) {
  accepts<files::IoError>([&] {
    bus_log::for_each_output(
        reader, address,
        [](const FusedPose& pose) { promise(pose.address == address, "a pose is of the beacon"); },
        [](const FixReport& report) { promise(report.address == address, "a report is of the beacon"); });
  });
}

/// `max_events`: of a recording of ROS 2, compressed chunks may have any number.
void check_inputs(std::string_view input, std::size_t max_events) {
  static const ScratchFolder folder;
  be_quiet();
  const auto file = folder.write("input.mcap", input);
  accepts<files::IoError>([&] { check_log(bus_log::read_sensor_log(file), max_events); });
  accepts<files::IoError>([&] {
    for (const ImuSample& imu : bus_log::read_imu_log(file, address)) {
      promise(imu.address == address, "a sample is of the beacon");
    }
  });
}

bool is_of_the_bus(const mcap::Reader& reader) {
  return std::ranges::any_of(reader.channels(), [](const auto& entry) {
    return sonopose::dds::topics::find_topic(entry.second.topic) != nullptr;
  });
}

bool is_of_ros(const mcap::Reader& reader) {
  return std::ranges::any_of(reader.schemas(),
                             [](const auto& entry) { return entry.second.encoding.starts_with("ros2"); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  accepts<files::IoError>([&] {  // a FormatError, or the limit of expansion
    const mcap::Reader reader(std::make_unique<InputSource>(std::as_bytes(std::span(data, size))));
    check(reader);
    check_limits(reader);
    if (is_of_ros(reader)) {
      check_inputs(text_of(data, size), SIZE_MAX);
    } else if (is_of_the_bus(reader)) {
      check_outputs(reader);
      check_inputs(text_of(data, size), size);
    }
  });
  return 0;
}
