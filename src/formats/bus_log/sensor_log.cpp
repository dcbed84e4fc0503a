#include "bus_log/sensor_log.hpp"

#include "bus_log/dashboard_log.hpp"
#include "bus_log/decoded.hpp"
#include "bus_log/recording_files.hpp"
#include "logging/log.hpp"
#include "mcap/reader.hpp"
#include "recording/input_check.hpp"
#include "recording/log_columns.hpp"
#include "recording/merge.hpp"
#include "ros2/bag/bag_log.hpp"
#include <sonopose/collation/collator.hpp>
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace sonopose::bus_log {

namespace {

namespace topics = dds::topics;

/// Time that an event waits for an earlier one that the recorder received later. The live fusion waits less;
/// a replay can wait longer.
constexpr TimeNs collation_timeout_ns = 1'000'000'000;

bool is_input(const mcap::Channel& channel) {
  return channel.topic == topics::imu.name || channel.topic == topics::fix.name ||
         channel.topic == topics::heading.name || channel.topic == topics::twist.name;
}

bool is_command(const std::string& topic) {
  return topic == topics::reset.name || topic == topics::settings.name;
}

bool is_read(const mcap::Channel& channel) {
  return is_input(channel) || is_command(channel.topic) || channel.topic == topics::truth.name;
}

/// One beacon of one recording.
class FileLog {
public:
  FileLog(const mcap::Reader& reader, std::optional<BeaconAddress> address) : reader_{reader} {
    require_our_types(reader_, is_known_);
    address_ = chosen(address);
  }

  recording::SensorLog read() {
    log_.address = address_;
    log_.warnings = reader_.damages();
    // File order, since the host's clock may have been set back meanwhile.
    mcap::Messages messages(reader_, {.channel = is_known_, .order = mcap::Selection::Order::file});
    while (const auto message = messages.next()) add(*message);
    warn();
    recording::leave_far_ahead_out(reader_.name(), log_);
    recording::sort_by_time(reader_.name(), "true poses", log_.truth, log_.warnings);
    return std::move(log_);
  }

private:
  /// Commands of unknown type are tolerable: a replay only counts commands.
  [[nodiscard]] bool is_unknown_command(const mcap::Channel& channel) const {
    return is_command(channel.topic) && !has_our_type(reader_, channel);
  }

  [[nodiscard]] BeaconAddress chosen(std::optional<BeaconAddress> address) const {
    const std::set<BeaconAddress> found = addresses();
    if (found.empty()) {
      throw files::IoError(reader_.name() + ": has no message of the topics " + topics::imu.name + ", " +
                           topics::fix.name + " or " + topics::heading.name);
    }
    if (address && !found.contains(*address)) {
      throw files::IoError(
          fmt::format("{}: has no beacon {}; it has {}", reader_.name(), *address, fmt::join(found, ", ")));
    }
    if (!address && found.size() > 1) {
      throw files::IoError(fmt::format("{}: has {} beacons; choose one with --beacon: {}", reader_.name(),
                                       found.size(), fmt::join(found, ", ")));
    }
    return address.value_or(*found.begin());
  }

  [[nodiscard]] std::set<BeaconAddress> addresses() const {
    std::set<BeaconAddress> found;
    mcap::Messages messages(reader_, {.channel = is_input, .order = mcap::Selection::Order::file});
    while (const auto message = messages.next()) {
      if (const auto address = topics::beacon_of(message->data)) found.insert(*address);
    }
    return found;
  }

  void add(const mcap::Message& message) {
    const auto address = topics::beacon_of(message.data);
    const std::string& topic = reader_.channels().at(message.channel_id).topic;
    if (is_command(topic) && (address == address_ || address == all_beacons))
      return add_command(topic, message);
    if (address != address_) return;
    if (topic == topics::imu.name) {
      collate(decoded(topics::imu, reader_, message), message);
    } else if (topic == topics::fix.name) {
      collate(decoded(topics::fix, reader_, message), message);
    } else if (topic == topics::heading.name) {
      collate(decoded(topics::heading, reader_, message), message);
    } else if (topic == topics::twist.name) {
      collate(decoded(topics::twist, reader_, message), message);
    } else if (topic == topics::truth.name) {
      const TruthSample truth = decoded(topics::truth, reader_, message);
      require_time(truth.time_ns, message);
      log_.truth.push_back(truth);
    }
  }

  /// Counts resets and changes of settings, which a replay does not repeat.
  void add_command(const std::string& topic, const mcap::Message& message) {
    if (topic == topics::reset.name) {
      ++reset_count_;
      return;
    }
    const EffectiveSettings settings = decoded(topics::settings, reader_, message);
    const auto [known, is_new] = settings_.try_emplace(settings.address, settings.values);
    if (is_new || known->second == settings.values) return;
    known->second = settings.values;
    ++settings_change_count_;
  }

  void require_time(TimeNs time_ns, const mcap::Message& message) const {
    // The same limit as in a log folder: the difference of any two times then fits into 64 bits.
    constexpr TimeNs too_late = TimeNs{1} << 62U;
    if (time_ns > 0 && time_ns < too_late) return;
    fail(reader_, message,
         "has the time " + std::to_string(time_ns) + ", which is not between 1 and 2^62 - 1 ns");
  }

  void collate(const Event& event, const mcap::Message& message) {
    require_time(available_at_ns(event), message);
    ++input_count_;
    if (first_sequence_ == 0) first_sequence_ = sequence_of(event);
    constexpr auto latest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max() / 2);
    const auto log_time_ns = static_cast<std::int64_t>(std::min(message.log_time_ns, latest));
    arrival_ = std::max(arrival_, SteadyTime{log_time_ns});
    for (const collation::CollatedEvent& next : collator_.push(event, arrival_)) {
      Event numbered = next.event;
      std::visit([this](auto& sample) { sample.sequence = log_.events.size() + 1; }, numbered);
      log_.events.push_back(std::move(numbered));
    }
  }

  void warn() {
    const auto warn_of = [this](std::string_view before, std::uint64_t count, std::string_view noun,
                                std::string_view after) {
      if (count == 0) return;
      log_.warnings.push_back(
          fmt::format("{}: {} {}{}", reader_.name(), before, text::count_text(count, noun), after));
    };
    const collation::CollatorCounters& counters = collator_.counters();
    if (first_sequence_ > 1) {
      log_.warnings.push_back(reader_.name() + ": begins with event " + std::to_string(first_sequence_) +
                              " of beacon " + std::to_string(address_) +
                              "; the state differs from that of a fusion that received the earlier ones");
    }
    warn_of("lacks", counters.lost, "event", " of the bridge");
    warn_of("leaves out", counters.duplicated, "event",
            " with numbers that came before: of two bridges, or too late");
    warn_of("the event numbers restarted", counters.restarts, "time", "");
    for (const auto& [id, channel] : reader_.channels()) {
      if (!is_unknown_command(channel)) continue;
      log_.warnings.push_back(other_type_text(reader_, channel) +
                              ", so it is not known whether they changed");
    }
    constexpr std::string_view not_repeated = ", which a replay does not repeat";
    warn_of("has", reset_count_, "reset", " of the beacon" + std::string(not_repeated));
    warn_of("has", settings_change_count_, "change", " of its settings" + std::string(not_repeated));
    warn_of("leaves out", input_count_ - log_.events.size() - counters.duplicated, "event",
            " at the end, because an earlier one is missing");
  }

  const mcap::Reader& reader_;
  std::function<bool(const mcap::Channel&)> is_known_ = [this](const mcap::Channel& channel) {
    return is_read(channel) && !is_unknown_command(channel);
  };
  BeaconAddress address_ = 0;
  collation::Collator collator_{collation_timeout_ns};
  std::uint64_t input_count_ = 0;
  std::uint64_t first_sequence_ = 0;
  SteadyTime arrival_;
  std::uint64_t reset_count_ = 0;
  std::uint64_t settings_change_count_ = 0;
  std::map<BeaconAddress, std::vector<SettingAssignment>> settings_;
  recording::SensorLog log_;
};

}  // namespace

namespace {

using Paths = std::vector<std::filesystem::path>;

void log_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) logging::warning(warning);
}

/// Returns true for a recording of rosbag2, and for one of both if topics of ROS 2 were chosen.
bool is_bag(const mcap::Reader& reader) {
  if (ros2::bag::chosen_topics().is_given()) return true;
  bool is_of_ros = reader.contents().profile == "ros2";
  for (const auto& [id, channel] : reader.channels()) {
    if (is_input(channel)) return false;
    const auto schema = reader.schemas().find(channel.schema_id);
    is_of_ros =
        is_of_ros || (schema != reader.schemas().end() && schema->second.encoding.starts_with("ros2"));
  }
  return is_of_ros;
}

/// Warns if topics were chosen for a recording that has none.
void warn_of_topics(const std::string& name) {
  if (!ros2::bag::chosen_topics().is_given()) return;
  logging::warning(name + ": not a ROS 2 recording: --imu-in, --fix-in and similar options do not apply");
}

/// Inputs that a caller needs.
enum class Needs { imu, all };

recording::SensorLog read_storage(const Paths& paths, const ros2::bag::Storage& storage,
                                  std::optional<BeaconAddress> address, bool needs_fixes) {
  std::uint64_t messages = 0;
  for (const ros2::bag::BagTopic& topic : storage.topics()) messages += topic.messages;
  if (const auto text = fewer_than_listed(paths, messages)) logging::warning(*text);
  ros2::bag::BagLog bag = ros2::bag::read_bag(storage, ros2::bag::chosen_topics(), address, needs_fixes);
  for (const std::string& note : bag.notes) logging::info(note);
  recording::leave_far_ahead_out(storage.name(), bag.log);
  return std::move(bag.log);
}

recording::SensorLog read_files(const Paths& paths, std::optional<BeaconAddress> address, Needs needs) {
  const bool needs_fixes = needs == Needs::all;
  if (is_in_sqlite(paths)) {
    const auto storage = ros2::bag::sqlite_storage(recording_files(paths));
    return read_storage(paths, *storage, address, needs_fixes);
  }
  const mcap::Reader reader(recording_files(paths));
  if (!is_bag(reader)) return FileLog(reader, address).read();
  return read_storage(paths, *ros2::bag::mcap_storage(reader), address, needs_fixes);
}

recording::SensorLog read_any(const Paths& paths, std::optional<BeaconAddress> address, Needs needs) {
  const std::filesystem::path& first = paths.front();
  const bool is_in_files = is_in_sqlite(paths) || is_in_mcap(paths);
  if (!is_in_files) warn_of_topics(name_of(paths));
  auto read = is_in_files            ? read_files(paths, address, needs)
              : is_log_folder(first) ? recording::read_sensor_log(first, address)
                                     : read_dashboard_log(first, address);
  std::ranges::move(recording::input_findings(name_of(paths), read.events, nullptr, read.truth),
                    std::back_inserter(read.warnings));
  log_warnings(read.warnings);
  return read;
}

std::vector<ImuSample> imu_of(const recording::SensorLog& log) {
  std::vector<ImuSample> samples;
  for (const Event& event : log.events) {
    if (const auto* imu = std::get_if<ImuSample>(&event)) samples.push_back(*imu);
  }
  return samples;
}

}  // namespace

std::filesystem::path imu_source(const std::filesystem::path& log) {
  return is_log_folder(log) ? log / recording::imu_file : log;
}

recording::SensorLog read_sensor_log(const std::filesystem::path& log, std::optional<BeaconAddress> address) {
  return read_sensor_log(Paths{log}, address);
}

recording::SensorLog read_sensor_log(const Paths& paths, std::optional<BeaconAddress> address) {
  return read_any(paths, address, Needs::all);
}

std::vector<ImuSample> read_imu_log(const std::filesystem::path& log, std::optional<BeaconAddress> address) {
  if (is_log_folder(log)) {
    warn_of_topics(log.string());
    recording::ImuLog read = recording::read_imu_log(log, address);
    log_warnings(read.warnings);
    return std::move(read.imu);
  }
  return imu_of(read_any({log}, address, Needs::imu));
}

recording::AttitudeLog read_attitude_log(const std::filesystem::path& log,
                                         std::optional<BeaconAddress> address) {
  if (is_log_folder(log)) {
    warn_of_topics(log.string());
    recording::AttitudeLog read = recording::read_attitude_log(log, address);
    log_warnings(read.warnings);
    return read;
  }
  recording::SensorLog read = read_any({log}, address, Needs::imu);
  recording::AttitudeLog attitude{.imu = imu_of(read), .truth = std::move(read.truth), .movements = {}};
  if (attitude.imu.empty()) throw files::IoError(log.string() + ": no IMU sample");
  return attitude;
}

}  // namespace sonopose::bus_log
