// An MCAP file of any content: its contents, its metadata, its messages in both orders, and as JSON.

#include "bus_log/messages.hpp"
#include "mcap/omg_idl.hpp"
#include "mcap/reader.hpp"
#include "mcap/verify.hpp"
#include "support.hpp"

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
  std::uint64_t count = 0;
  std::uint64_t last_ns = 0;
  while (const auto message = messages.next()) {
    promise(reader.channels().contains(message->channel_id), "a message has a channel");
    const bool is_by_time = order == mcap::Selection::Order::log_time;
    promise(!is_by_time || message->log_time_ns >= last_ns, "messages are in the order of time");
    last_ns = message->log_time_ns;
    for (const std::byte byte : message->data) seen = byte;  // all data can be read
    const mcap::Channel& channel = reader.channels().at(message->channel_id);
    promise(bus_log::json_of(channel, *message).find('\n') == std::string::npos,
            "a message as JSON is one line");
    std::ignore = bus_log::beacon_of(channel, *message);
    ++count;
  }
  return count;
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
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  accepts<mcap::FormatError>(
      [&] { check(mcap::Reader(std::make_unique<InputSource>(std::as_bytes(std::span(data, size))))); });
  return 0;
}
