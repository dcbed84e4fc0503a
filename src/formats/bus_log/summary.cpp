#include "bus_log/summary.hpp"

#include "bus_log/log_times.hpp"
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <tuple>

namespace sonopose::bus_log {

namespace {

constexpr double ns_per_s = 1e9;

double seconds_of(const mcap::TimeSpan& times) {
  return times.is_empty() ? 0.0 : static_cast<double>(times.end_ns - times.start_ns) / ns_per_s;
}

std::uint64_t count_of(const mcap::Reader& reader, std::uint16_t channel_id) {
  const auto& counts = reader.statistics().channel_message_counts;
  const auto found = counts.find(channel_id);
  return found == counts.end() ? 0 : found->second;
}

std::string schema_of(const mcap::Reader& reader, const mcap::Channel& channel) {
  const auto found = reader.schemas().find(channel.schema_id);
  return found == reader.schemas().end() ? std::string() : found->second.name;
}

/// Returns the channels in alphabetical order of their topics.
std::vector<const mcap::Channel*> channels_of(const mcap::Reader& reader) {
  std::vector<const mcap::Channel*> channels;
  for (const auto& [id, channel] : reader.channels()) channels.push_back(&channel);
  std::ranges::stable_sort(channels, {}, &mcap::Channel::topic);
  return channels;
}

/// Returns "2026-01-31 12:00:00.123 UTC".
std::string utc_text(std::uint64_t time_ns) {
  const std::uint64_t time_ms = time_ns / 1'000'000;
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03} UTC", fmt::gmtime(static_cast<std::time_t>(time_ms / 1000)),
                     time_ms % 1000);
}

double rate_of(std::uint64_t count, double duration_s) {
  return count > 1 && duration_s > 0 ? static_cast<double>(count - 1) / duration_s : 0.0;
}

}  // namespace

std::string summary_text(const mcap::Reader& reader, const std::vector<std::string>& more) {
  using text::escaped;
  const mcap::Statistics& statistics = reader.statistics();
  const double duration_s = seconds_of(statistics.log_times);
  std::string text = fmt::format("file      {}, {:.1f} MB\nwritten   by {}, profile \"{}\"\n",
                                 escaped(reader.name()), static_cast<double>(reader.size_bytes()) / 1e6,
                                 escaped(reader.contents().library), escaped(reader.contents().profile));
  if (!statistics.log_times.is_empty()) {
    text +=
        fmt::format("begins    {}\nends      {}, after {:.3f} s\n", utc_text(statistics.log_times.start_ns),
                    utc_text(statistics.log_times.end_ns), duration_s);
  }
  if (const auto gap = longest_gap_in(reader)) text += fmt::format("gap       {}\n", *gap);
  if (const auto step = step_back_in(reader)) text += fmt::format("clock     {}\n", escaped(*step));
  text += fmt::format("messages  {} in {}; {}\n\n", statistics.message_count,
                      text::count_text(statistics.chunk_count, "chunk"),
                      reader.contents().is_indexed ? "with an index" : "without an index");
  for (const mcap::Channel* channel : channels_of(reader)) {
    const std::uint64_t count = count_of(reader, channel->id);
    text += fmt::format("{:<28} {:>10} {:>9.1f} Hz  {} {}\n", escaped(channel->topic), count,
                        rate_of(count, duration_s), escaped(channel->message_encoding),
                        escaped(schema_of(reader, *channel)));
  }
  std::vector<std::string> damages = reader.damages();
  damages.insert(damages.end(), more.begin(), more.end());
  for (const mcap::Metadata& metadata : reader.metadata(damages)) {
    text += fmt::format("\n{}\n", escaped(metadata.name));
    for (const auto& [key, value] : metadata.values) {
      const bool is_long = value.find('\n') != std::string::npos;
      text += fmt::format("  {} {}\n", escaped(key),
                          is_long ? fmt::format("({} characters)", value.size()) : escaped(value));
    }
  }
  for (const std::string& damage : damages) text += fmt::format("\ndamaged: {}", escaped(damage));
  return damages.empty() ? text : text + "\n";
}

std::string summary_json(const mcap::Reader& reader, const std::vector<std::string>& more) {
  using Json = nlohmann::ordered_json;
  const mcap::Statistics& statistics = reader.statistics();
  Json json{{"file", reader.name()},
            {"bytes", reader.size_bytes()},
            {"library", reader.contents().library},
            {"profile", reader.contents().profile},
            {"start_ns", statistics.log_times.is_empty() ? 0 : statistics.log_times.start_ns},
            {"end_ns", statistics.log_times.end_ns},
            {"messages", statistics.message_count},
            {"chunks", statistics.chunk_count},
            {"indexed", reader.contents().is_indexed},
            {"topics", Json::array()},
            {"metadata", Json::array()}};
  for (const mcap::Channel* channel : channels_of(reader)) {
    json["topics"].push_back({{"topic", channel->topic},
                              {"messages", count_of(reader, channel->id)},
                              {"encoding", channel->message_encoding},
                              {"schema", schema_of(reader, *channel)}});
  }
  std::vector<std::string> damages = reader.damages();
  damages.insert(damages.end(), more.begin(), more.end());
  for (const mcap::Metadata& metadata : reader.metadata(damages)) {
    json["metadata"].push_back({{"name", metadata.name}, {"values", metadata.values}});
  }
  json["damages"] = damages;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool is_sound(const mcap::Reader& reader, const std::vector<std::string>& more) {
  std::vector<std::string> damages = reader.damages();
  std::ignore = reader.metadata(damages);
  return damages.empty() && more.empty();
}

}  // namespace sonopose::bus_log
