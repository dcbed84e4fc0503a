#include "bus_log/messages.hpp"

#include "json/json.hpp"
#include "mcap/chunk_messages.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/escaped.hpp>
#include <sonopose/text/hexadecimal.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace sonopose::bus_log {

namespace {

namespace topics = dds::topics;

constexpr std::string_view instance_ends = "sonopose/instance_ends";

/// Operations on the messages of one topic.
struct TopicReader {
  bool has_beacon = false;
  /// Returns an empty text if the bytes are not a sample.
  std::string (*json)(std::span<const std::byte> cdr) = nullptr;
};

template <class T>
std::string json_of_sample(std::span<const std::byte> cdr) {
  const dds::CdrSample<T> sample(cdr);
  return sample.get() == nullptr ? std::string() : json::json_of(*sample.get());
}

/// True for a sample of one mobile beacon. The map is of all.
template <class T>
constexpr bool has_address = !std::is_same_v<T, sonopose_StationaryBeacon> && requires(const T& sample) {
  sample.address;
};

const TopicReader* find_topic(const mcap::Channel& channel) {
  static const auto readers = std::apply(
      []<class... T>(const topics::Entry<T>&... entries) {
        return std::map<std::string_view, TopicReader>{
            {entries.name, TopicReader{has_address<T>, json_of_sample<T>}}...};
      },
      topics::all);
  const auto found = readers.find(channel.topic);
  return found == readers.end() || channel.message_encoding != "cdr" ? nullptr : &found->second;
}

std::string_view text_of(const mcap::Message& message) {
  return {reinterpret_cast<const char*>(message.data.data()), message.data.size()};
}

/// Returns empty if the text is not JSON, or so deep that writing it, which recurses, could overflow the
/// stack.
std::optional<nlohmann::ordered_json> parse_json(std::string_view text) {
  using Ordered = nlohmann::ordered_json;
  constexpr int max_depth = 256;
  bool is_too_deep = false;
  const auto keep = [&is_too_deep](int depth, Ordered::parse_event_t, const Ordered&) {
    is_too_deep = is_too_deep || depth > max_depth;
    return !is_too_deep;
  };
  Ordered parsed = Ordered::parse(text, keep, false);
  if (is_too_deep || parsed.is_discarded()) return std::nullopt;
  return parsed;
}

/// Writes `"message": …` or `"data": "…"`.
std::string content_of(const mcap::Channel& channel, const mcap::Message& message) {
  std::string json;
  if (channel.message_encoding == "json") {
    if (const auto parsed = parse_json(text_of(message))) {
      json = parsed->dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    }
  } else if (const TopicReader* topic = find_topic(channel)) {
    json = topic->json(message.data);
  }
  if (!json.empty()) return R"("message":)" + json;
  return fmt::format(R"("data":"{}")", text::hexadecimal(message.data));
}

/// Returns the address in the key of an ended instance.
std::optional<BeaconAddress> beacon_of_end(const mcap::Message& message) {
  const auto parsed = parse_json(text_of(message));
  if (!parsed || !parsed->is_object() || !parsed->contains("key")) return std::nullopt;
  const auto& key = parsed->at("key");
  if (!key.is_object() || !key.contains("address") || !key["address"].is_number_unsigned())
    return std::nullopt;
  const auto address = key["address"].get<std::uint64_t>();
  if (address > std::numeric_limits<BeaconAddress>::max()) return std::nullopt;
  return static_cast<BeaconAddress>(address);
}

/// The topic of the file that the user names, with or without what precedes the name. Throws files::IoError.
std::string topic_of(const mcap::Reader& reader, const std::string& name) {
  const std::string* alike = nullptr;
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.topic == name) return name;
    if (topics::short_name(channel.topic) == topics::short_name(name)) alike = &channel.topic;
  }
  if (alike != nullptr) return *alike;
  std::vector<std::string> known;
  for (const auto& [id, channel] : reader.channels()) known.push_back(text::escaped(channel.topic));
  throw files::IoError(
      fmt::format("{}: has no topic {}; it has {}", reader.name(), name, fmt::join(known, ", ")));
}

mcap::Selection selection_of(const mcap::Reader& reader, const Choice& choice,
                             mcap::Selection::Damaged damaged, mcap::Selection::Order order) {
  mcap::Selection selection;
  selection.order = order;
  selection.damaged = damaged;
  std::vector<std::string> wanted;
  for (const std::string& topic : choice.topics) wanted.push_back(topic_of(reader, topic));
  if (!wanted.empty()) {
    selection.channel = [wanted](const mcap::Channel& channel) {
      return std::ranges::find(wanted, channel.topic) != wanted.end();
    };
  }
  const mcap::TimeSpan& times = reader.statistics().log_times;
  if (times.is_empty()) return selection;
  const mcap::TimeSpan part = part_of(times, choice.start, choice.end);
  selection.start_ns = part.start_ns;
  selection.end_ns = part.end_ns;
  if (part.start_ns > times.end_ns || part.end_ns < times.start_ns) {
    throw nothing_selected({&reader}, reader.statistics().message_count);
  }
  return selection;
}

/// Writes the line of a message with its content.
std::string line_with(const std::string& content, const mcap::Channel& channel,
                      const mcap::Message& message) {
  const nlohmann::json topic(channel.topic);
  return fmt::format(R"({{"topic":{},"sequence":{},"log_time_ns":{},"publish_time_ns":{},{}}})",
                     topic.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), message.sequence,
                     message.log_time_ns, message.publish_time_ns, content);
}

}  // namespace

files::IoError nothing_selected(const std::vector<const mcap::Reader*>& readers, std::uint64_t message_count,
                                const std::string& reason) {
  std::string text;
  for (const mcap::Reader* reader : readers) text += (text.empty() ? "" : ", ") + reader->name();
  text += fmt::format(": none of {} {} messages is selected or readable",
                      readers.size() == 1 ? "its" : "their", message_count);
  const mcap::TimeSpan& times = readers.front()->statistics().log_times;
  if (readers.size() == 1 && !times.is_empty()) {
    text +=
        fmt::format("; they last {:.3f} s, from {} to {} ns",
                    static_cast<double>(times.end_ns - times.start_ns) * 1e-9, times.start_ns, times.end_ns);
  }
  if (!reason.empty()) text += "; " + reason;
  return files::IoError{text};
}

std::optional<BeaconAddress> beacon_of(const mcap::Channel& channel, const mcap::Message& message) {
  if (channel.topic == instance_ends) return beacon_of_end(message);
  const TopicReader* topic = find_topic(channel);
  if (channel.topic == topics::stationary_beacon.name) return all_beacons;
  if (topic == nullptr || !topic->has_beacon) return std::nullopt;
  return topics::beacon_of(message.data);
}

std::string json_of(const mcap::Channel& channel, const mcap::Message& message) {
  return line_with(content_of(channel, message), channel, message);
}

std::string MessageLines::line_of(const mcap::Channel& channel, const mcap::Message& message) {
  const auto schema = reader_.schemas().find(channel.schema_id);
  const bool is_of_ros = schema != reader_.schemas().end() && schema->second.encoding == "ros2msg" &&
                         (channel.message_encoding == "cdr" || channel.message_encoding.empty());
  if (!is_of_ros) return json_of(channel, message);
  const auto [known, is_new] = definitions_.try_emplace(schema->first);
  auto& definition = known->second;
  if (is_new) definition = ros2::bag::MessageDefinition::parse(schema->second.name, schema->second.data);
  const std::string json = definition ? definition->json_of(message.data) : "";
  return json.empty() ? json_of(channel, message) : line_with(R"("message":)" + json, channel, message);
}

ChosenMessages::ChosenMessages(const mcap::Reader& reader, const Choice& choice,
                               mcap::Selection::Damaged damaged, mcap::Selection::Order order)
    : reader_{reader},
      beacon_{choice.beacon},
      selection_{selection_of(reader, choice, damaged, order)},
      messages_{reader, selection_} {}

void ChosenMessages::begin_with_latched() {
  if (selection_.start_ns > 0) latched_ = latched_start(reader_, selection_, dds::qos::Provider());
}

std::optional<mcap::Message> ChosenMessages::next_of_all() {
  const auto& latched = latched_.samples.entries();
  if (next_latched_ == latched.size()) return messages_.next();
  return message_at(latched_.samples, latched[next_latched_++]);
}

std::optional<ChosenMessages::Chosen> ChosenMessages::next() {
  while (const auto message = next_of_all()) {
    const mcap::Channel& channel = reader_.channels().at(message->channel_id);
    if (!beacon_) return Chosen{&channel, *message};
    const auto beacon = beacon_of(channel, *message);
    if (beacon && beacon != all_beacons) found_beacons_.insert(*beacon);
    if (beacon == beacon_ || beacon == all_beacons) return Chosen{&channel, *message};
  }
  require_beacon();
  return std::nullopt;
}

void ChosenMessages::require_beacon() const {
  if (!beacon_ || beacon_ == all_beacons || found_beacons_.contains(*beacon_)) return;
  throw files::IoError(fmt::format(
      "{}: no selected message belongs to beacon {}; they belong to {}", reader_.name(), *beacon_,
      found_beacons_.empty() ? std::string("none") : fmt::format("{}", fmt::join(found_beacons_, ", "))));
}

}  // namespace sonopose::bus_log
