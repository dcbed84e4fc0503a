#include "web/recording/recording_json.hpp"

#include "bus_log/decoded.hpp"
#include "bus_log/moment.hpp"
#include "bus_log/recording_files.hpp"
#include "bus_log/sensor_log.hpp"
#include "evaluation/replay/run.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "mcap/reader.hpp"
#include "web/recording/document.hpp"

#include <algorithm>
#include <cstdint>
#include <set>

namespace sonopose::web::recording {
namespace {

namespace topics = dds::topics;

void warn_of(const std::vector<std::string>& damages) {
  for (const std::string& damage : damages) logging::warning(damage);
}

bool is_shown(const mcap::Channel& channel) {
  return channel.topic == topics::pose.name || channel.topic == topics::report.name ||
         channel.topic == topics::truth.name || channel.topic == topics::stationary_beacon.name;
}

/// True for channels that are shown additionally, if recorded in the types of this version.
bool is_status(const mcap::Channel& channel) {
  return channel.topic == topics::beacon_status.name || channel.topic == topics::fusion_status.name ||
         channel.topic == topics::estimate.name || channel.topic == topics::log.name;
}

/// Selects the shown channels. Warns about statuses of other types.
std::set<std::uint16_t> shown_channels(const mcap::Reader& reader) {
  std::set<std::uint16_t> shown;
  for (const auto& [id, channel] : reader.channels()) {
    const bool is_readable = !is_status(channel) || bus_log::has_our_type(reader, channel);
    if (!is_readable) logging::warning(bus_log::other_type_text(reader, channel) + ": not shown");
    if (is_readable && (is_status(channel) || is_shown(channel))) shown.insert(id);
  }
  return shown;
}

/// Recorded outputs; empty if there are no poses.
std::optional<std::string> recorded_outputs(const mcap::Reader& reader, std::optional<BeaconAddress> beacon) {
  const auto& times = reader.statistics().log_times;
  if (times.is_empty()) return {};
  Document document(1e-9 * static_cast<double>(times.end_ns - times.start_ns), beacon);
  bus_log::require_our_types(reader, is_shown);
  mcap::Selection selection;
  selection.channel = [shown = shown_channels(reader)](const mcap::Channel& channel) {
    return shown.contains(channel.id);
  };
  selection.damaged = mcap::Selection::Damaged::skip;
  mcap::Messages messages(reader, selection);
  const auto add = [&](const auto& sample, auto... received_ns) {
    if (!beacon || sample.address == *beacon) document.add(sample, received_ns...);
  };
  while (const auto message = messages.next()) {
    const std::string& topic = reader.channels().at(message->channel_id).topic;
    const TimeNs log_time_ns = bus_log::time_of(message->log_time_ns);
    document.advance(log_time_ns);
    if (topic == topics::pose.name) {
      add(bus_log::decoded(topics::pose, reader, *message), log_time_ns);
    } else if (topic == topics::report.name) {
      add(bus_log::decoded(topics::report, reader, *message));
    } else if (topic == topics::truth.name) {
      add(bus_log::decoded(topics::truth, reader, *message));
    } else if (topic == topics::beacon_status.name) {
      add(bus_log::decoded(topics::beacon_status, reader, *message));
    } else if (topic == topics::fusion_status.name) {
      add(bus_log::decoded(topics::fusion_status, reader, *message));
    } else if (topic == topics::estimate.name) {
      add(bus_log::decoded(topics::estimate, reader, *message));
    } else if (topic == topics::log.name) {
      document.add(bus_log::decoded(topics::log, reader, *message));
    } else {
      document.add(bus_log::decoded(topics::stationary_beacon, reader, *message));
    }
  }
  if (!document.has_poses()) return {};
  warn_of(reader.damages());
  warn_of(messages.skipped());
  return document.json();
}

}  // namespace

std::string recording_json(const std::vector<std::filesystem::path>& recording,
                           std::optional<BeaconAddress> beacon) {
  if (bus_log::is_in_mcap(recording)) {
    const mcap::Reader reader(bus_log::recording_files(recording));
    if (auto text = recorded_outputs(reader, beacon)) return *std::move(text);
  }
  const sonopose::recording::SensorLog log = bus_log::read_sensor_log(recording, beacon);
  if (log.events.empty()) throw files::IoError(bus_log::name_of(recording) + ": has no samples");
  Document document(seconds_between(available_at_ns(log.events.front()), available_at_ns(log.events.back())));
  for (TruthSample truth : log.truth) {
    truth.address = log.address;
    document.add(truth);
  }
  evaluation::run(log, {},
                  {[&](const FusedPose& pose) { document.add(pose); },
                   [&](const FixReport& report) { document.add(report); }});
  return document.json();
}

}  // namespace sonopose::web::recording
