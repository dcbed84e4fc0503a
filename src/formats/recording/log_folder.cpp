#include "recording/log_folder.hpp"

#include "csv/reader.hpp"
#include "csv/units.hpp"
#include "files/missing.hpp"
#include "recording/input_check.hpp"
#include "recording/log_columns.hpp"
#include "recording/log_meta.hpp"
#include "recording/step_back.hpp"
#include "recording/unread_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace sonopose::recording {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// The rows of imu.csv, one at a time.
class ImuRows {
public:
  ImuRows(const std::filesystem::path& file, BeaconAddress address, ImuMeaning meaning,
          const csv::Layout& layout = imu_layout())
      : rows_{file, layout}, is_table_(layout.given_names != nullptr) {
    sample_.address = address;
    sample_.meaning = meaning;
    step();
  }

  /// The current sample; null after the last.
  [[nodiscard]] const ImuSample* current() const { return at_end_ ? nullptr : &sample_; }

  void step() {
    for (;;) {
      at_end_ = !rows_.next_row();
      if (at_end_ || !is_table_ || rows_.filled(0, 7) == 7) break;
      ++left_out_;
      if (rows_.filled(1, 6) > 0) ++incomplete_;
    }
    if (at_end_) return;
    sample_.sensor_time_ns = rows_.time_ns(0);
    sample_.angular_velocity_body_radps = rows_.vector(1);
    sample_.specific_force_body_mps2 = rows_.vector(4);
    sample_.magnetic_field_body_t.reset();
    if (!rows_.all_filled(7, 3)) return;
    sample_.magnetic_field_body_t.emplace(rows_.number_in(csv::microtesla, 7),
                                          rows_.number_in(csv::microtesla, 8),
                                          rows_.number_in(csv::microtesla, 9));
  }

  [[nodiscard]] std::size_t expected_count() const { return at_end_ ? 0 : rows_.rows_like_this(); }
  /// Number of rows without all IMU values so far, and of those that have some.
  [[nodiscard]] std::size_t left_out() const { return left_out_; }
  [[nodiscard]] std::size_t incomplete() const { return incomplete_; }

private:
  csv::Reader rows_;
  bool is_table_;  ///< has rows of other measurements
  std::size_t left_out_ = 0;
  std::size_t incomplete_ = 0;
  ImuSample sample_;
  bool at_end_ = false;
};

/// Samples in memory, one at a time.
template <class Sample>
class Samples {
public:
  explicit Samples(const std::vector<Sample>& samples) : samples_(samples) {}
  [[nodiscard]] const Sample* current() const { return next_ < samples_.size() ? &samples_[next_] : nullptr; }
  void step() { ++next_; }
  [[nodiscard]] std::size_t expected_count() const { return samples_.size(); }

private:
  const std::vector<Sample>& samples_;
  std::size_t next_ = 0;
};

/// Compares correctly even if the difference does not fit into a TimeNs.
bool is_later_by_more(TimeNs later, TimeNs earlier, std::uint64_t by_ns) {
  return later > earlier && static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier) > by_ns;
}

/// IMU samples from any source, without those whose stamps are far ahead.
template <class ImuSamples>
class LookAhead {
public:
  explicit LookAhead(ImuSamples samples) : samples_(std::move(samples)) { look_ahead(); }

  [[nodiscard]] const ImuSample* current() const { return in_view_.empty() ? nullptr : &in_view_.front(); }

  void step() {
    before_ns_ = in_view_.front().sensor_time_ns;
    ++passed_;
    in_view_.pop_front();
    look_ahead();
  }

  [[nodiscard]] std::size_t expected_count() const { return in_view_.size() + samples_.expected_count(); }

  /// One sentence about the samples that were left out, if there are any.
  [[nodiscard]] std::vector<std::string> warnings(const std::string& name) const {
    if (left_out_ == 0) return {};
    return {
        fmt::format("{}: {} of {} IMU samples are left out: stamped ahead of those that follow, the first "
                    "by {:.1f} s",
                    name, left_out_, passed_ + left_out_, first_ahead_s_)};
  }

private:
  static constexpr std::size_t max_ahead = 63;
  static constexpr std::size_t max_after = 128;
  static constexpr std::uint64_t far_ns = 1'000'000'000;

  void look_ahead() {
    for (;; in_view_.pop_front()) {
      for (; in_view_.size() <= max_after && samples_.current() != nullptr; samples_.step()) {
        in_view_.push_back(*samples_.current());
      }
      const auto follows_ns = stamp_ahead_of();
      if (!follows_ns) return;
      const TimeNs expected_ns = before_ns_.value_or(*follows_ns);
      if (left_out_++ == 0) first_ahead_s_ = seconds_between(expected_ns, in_view_.front().sensor_time_ns);
    }
  }

  /// The stamp at which a file goes on after samples that are stamped ahead, if the first in view is one: far
  /// ahead of it and of the sample before. Neither a silence nor a file in reverse order has one.
  [[nodiscard]] std::optional<TimeNs> stamp_ahead_of() const {
    if (in_view_.empty()) return std::nullopt;
    const TimeNs stamp_ns = in_view_.front().sensor_time_ns;
    if (before_ns_ && !is_later_by_more(stamp_ns, *before_ns_, far_ns)) return std::nullopt;
    const auto step_back = std::adjacent_find(
        in_view_.begin(), in_view_.end(), [](const ImuSample& earlier, const ImuSample& later) {
          return is_later_by_more(earlier.sensor_time_ns, later.sensor_time_ns, far_ns);
        });
    if (step_back == in_view_.end()) return std::nullopt;
    const auto ahead = static_cast<std::size_t>(step_back - in_view_.begin()) + 1;
    if (ahead > max_ahead || 2 * ahead > in_view_.size()) return std::nullopt;
    std::vector<TimeNs> after_ns;  // one of three may be wrong too
    for (auto each = step_back + 1; each != in_view_.end() && after_ns.size() < 3; ++each)
      after_ns.push_back(each->sensor_time_ns);
    std::sort(after_ns.begin(), after_ns.end());
    const TimeNs next_ns = after_ns[std::min<std::size_t>(1, after_ns.size() - 1)];
    return is_later_by_more(stamp_ns, next_ns, far_ns) ? std::optional(next_ns) : std::nullopt;
  }

  ImuSamples samples_;
  std::deque<ImuSample> in_view_;
  std::optional<TimeNs> before_ns_;  ///< stamp of the previous sample
  std::size_t passed_ = 0;
  std::size_t left_out_ = 0;
  double first_ahead_s_ = 0.0;  ///< lead of the first sample that was left out
};

/// The IMU samples among events, one at a time.
class ImuOfEvents {
public:
  explicit ImuOfEvents(const std::vector<Event>& events) : events_(events) { find(); }
  [[nodiscard]] const ImuSample* current() const {
    return next_ < events_.size() ? std::get_if<ImuSample>(&events_[next_]) : nullptr;
  }
  void step() {
    ++next_;
    find();
  }
  [[nodiscard]] std::size_t expected_count() const { return events_.size() - next_; }

private:
  void find() {
    while (next_ < events_.size() && !std::holds_alternative<ImuSample>(events_[next_])) ++next_;
  }

  const std::vector<Event>& events_;
  std::size_t next_ = 0;
};

/// merge_by_availability with IMU samples from any source; `open_imu()` returns them once more.
template <class ImuSamples, class OpenImu>
SensorLog merged(const std::string& name, ImuSamples imu_samples, const OpenImu& open_imu,
                 Samples<UltrasonicFix> all_fixes, Samples<PairHeading> all_headings,
                 Samples<TwistSample> all_twists) {
  std::vector<StepsBack> steps{
      {}, steps_back_of(all_fixes), steps_back_of(all_headings), steps_back_of(all_twists)};
  // Reads the IMU samples twice only for a log whose clock may have been set back.
  const bool may_be_cut = std::ranges::any_of(steps, [](const auto& of) { return !of.found().empty(); });
  if (may_be_cut) steps.front() = steps_back_of(LookAhead{open_imu()});
  const auto cuts = cuts_at_common_steps(steps);
  Pieces imu{LookAhead(std::move(imu_samples)), cuts[0]};
  Pieces fixes(all_fixes, cuts[1]);
  Pieces headings(all_headings, cuts[2]);
  Pieces twists(all_twists, cuts[3]);
  SensorLog log;
  std::vector<Event>& events = log.events;
  events.reserve(imu.stream().expected_count() + all_fixes.expected_count() + all_headings.expected_count() +
                 all_twists.expected_count());
  const auto append = [&events](auto& samples) {
    auto sample = *samples.current();
    sample.sequence = events.size() + 1;
    events.emplace_back(std::move(sample));
    samples.step();
  };
  const auto next_ns = [](const auto& samples) {
    return samples.current() != nullptr ? available_at_ns(*samples.current())
                                        : std::numeric_limits<TimeNs>::max();
  };
  std::size_t pieces_left = cuts[0].size();
  while (true) {
    if (imu.current() == nullptr && fixes.current() == nullptr && headings.current() == nullptr &&
        twists.current() == nullptr) {
      if (pieces_left-- == 0) break;
      imu.begin_next();
      fixes.begin_next();
      headings.begin_next();
      twists.begin_next();
      continue;
    }
    const TimeNs next_event_ns = std::min({next_ns(imu), next_ns(fixes), next_ns(headings), next_ns(twists)});
    const auto is_next = [&](const auto& samples) {
      return samples.current() != nullptr && next_ns(samples) == next_event_ns;
    };
    if (is_next(imu)) {
      append(imu);
    } else if (is_next(fixes)) {
      append(fixes);
    } else if (is_next(headings)) {
      append(headings);
    } else {
      append(twists);
    }
  }
  log.warnings = imu.stream().warnings(name);
  return log;
}

/// Throws if the folder is no log but contains logs of several beacons.
void check_single(const std::filesystem::path& folder) {
  if (files::is_present(folder / imu_file)) return;
  std::vector<std::string> beacons;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::error_code not_accessible;
    if (exists(entry.path() / imu_file, not_accessible)) beacons.push_back(entry.path().filename().string());
  }
  if (beacons.empty()) return;
  std::sort(beacons.begin(), beacons.end());
  throw files::IoError(fmt::format("{}: has the logs of several beacons: {}; name one of them",
                                   folder.string(), fmt::join(beacons, ", ")));
}

/// Reads the metadata and sets the address that the samples get.
LogMeta meta_of(const std::filesystem::path& folder, std::optional<BeaconAddress> given_address) {
  files::require_folder(folder);
  check_single(folder);
  LogMeta meta = read_log_meta(folder);
  if (!meta.beacon_address) meta.beacon_address = default_log_address;
  if (given_address) meta.beacon_address = given_address;
  return meta;
}

}  // namespace

SensorLog read_sensor_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address) {
  const LogMeta meta = meta_of(folder, address);
  const BeaconAddress own_address = *meta.beacon_address;
  // Most events are IMU samples: merge each as soon as it is read instead of storing it twice.
  const auto open_imu = [&] { return ImuRows(folder / imu_file, own_address, meta.imu_meaning); };
  ImuRows imu = open_imu();
  const auto fixes = read_ultrasonic_csv(folder / ultrasonic_file, own_address);
  std::vector<PairHeading> headings;
  if (files::is_present(folder / heading_file))
    headings = read_heading_csv(folder / heading_file, own_address);
  std::vector<TwistSample> twists;
  if (files::is_present(folder / twist_file)) twists = read_twist_csv(folder / twist_file, own_address);
  SensorLog log =
      merged(folder.string(), std::move(imu), open_imu, Samples(fixes), Samples(headings), Samples(twists));
  log.address = own_address;
  std::ranges::move(unread_tables(folder), std::back_inserter(log.warnings));
  if (files::is_present(folder / truth_file)) {
    log.truth = read_truth_csv(folder / truth_file, log.address);
    sort_by_time(folder.string(), "true poses", log.truth, log.warnings);
    const bool has_position = std::ranges::any_of(
        log.truth, [](const TruthSample& truth) { return truth.position_world_m.allFinite(); });
    if (!has_position)
      log.warnings.push_back((folder / truth_file).string() + ": has no row with a position");
  }
  if (files::is_present(folder / wheel_speed_file)) {
    log.wheel_speeds = read_wheel_speed_csv(folder / wheel_speed_file);
    sort_by_time(folder.string(), "wheel speeds", log.wheel_speeds, log.warnings);
  }
  return log;
}

ImuLog read_imu_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address) {
  const LogMeta meta = meta_of(folder, address);
  LookAhead imu(ImuRows(folder / imu_file, *meta.beacon_address, meta.imu_meaning));
  ImuLog log;
  for (; imu.current() != nullptr; imu.step()) log.imu.push_back(*imu.current());
  log.warnings = input_findings(folder.string(), log.imu);
  for (std::string& warning : imu.warnings(folder.string())) log.warnings.push_back(std::move(warning));
  return log;
}

void leave_far_ahead_out(const std::string& name, SensorLog& log) {
  std::vector<Event>& events = log.events;
  LookAhead imu{ImuOfEvents(events)};
  std::vector<std::uint64_t> kept;
  for (; imu.current() != nullptr; imu.step()) kept.push_back(imu.current()->sequence);
  std::vector<std::string> warnings = imu.warnings(name);
  if (warnings.empty()) return;
  auto next = kept.begin();
  std::erase_if(events, [&](const Event& event) {
    if (!std::holds_alternative<ImuSample>(event)) return false;
    const bool is_kept = next != kept.end() && *next == sequence_of(event);
    if (is_kept) ++next;
    return !is_kept;
  });
  std::uint64_t sequence = 0;
  for (Event& event : events) std::visit([&](auto& sample) { sample.sequence = ++sequence; }, event);
  std::ranges::move(warnings, std::back_inserter(log.warnings));
}

SensorLog merge_by_availability(const std::string& name, const std::vector<ImuSample>& imu,
                                const std::vector<UltrasonicFix>& fixes,
                                const std::vector<PairHeading>& headings,
                                const std::vector<TwistSample>& twists) {
  const auto open_imu = [&imu] { return Samples(imu); };
  return merged(name, open_imu(), open_imu, Samples(fixes), Samples(headings), Samples(twists));
}

std::vector<ImuSample> read_imu_csv(const std::filesystem::path& file, BeaconAddress address) {
  return read_imu_table(file, address, imu_layout()).samples;
}

ImuTable read_imu_table(const std::filesystem::path& file, BeaconAddress address, const csv::Layout& layout) {
  ImuTable table;
  ImuRows rows(file, address, ImuMeaning::unknown, layout);
  for (; rows.current() != nullptr; rows.step()) table.samples.push_back(*rows.current());
  table.rows_without_values = rows.left_out();
  table.incomplete_rows = rows.incomplete();
  return table;
}

std::vector<UltrasonicFix> read_ultrasonic_csv(const std::filesystem::path& file, BeaconAddress address) {
  csv::Reader rows(file, layout_of(ultrasonic_columns, ultrasonic_columns_required));
  std::vector<UltrasonicFix> fixes;
  while (rows.next_row()) {
    UltrasonicFix& fix = fixes.emplace_back();
    fix.address = address;
    fix.emission_time_ns = rows.time_ns(0);
    fix.received_time_ns = rows.time_ns(1);
    fix.position_world_m = rows.vector(2);
    fix.quality_percent = rows.optional_number(5);
    fix.measured_delay_s = seconds_between(fix.emission_time_ns, fix.received_time_ns);
  }
  return fixes;
}

std::vector<PairHeading> read_heading_csv(const std::filesystem::path& file, BeaconAddress address) {
  csv::Reader rows(file, layout_of(heading_columns, heading_columns.size()));
  std::vector<PairHeading> headings;
  while (rows.next_row()) {
    PairHeading& heading = headings.emplace_back();
    heading.address = address;
    heading.emission_time_ns = rows.time_ns(0);
    heading.received_time_ns = rows.time_ns(1);
    heading.valid = !rows.is_empty(2);
    if (heading.valid) heading.heading_world_rad = rows.number_in(csv::degree, 2);
  }
  return headings;
}

std::vector<TwistSample> read_twist_csv(const std::filesystem::path& file, BeaconAddress address) {
  csv::Reader rows(file, layout_of(twist_columns, twist_columns_required));
  std::vector<TwistSample> twists;
  while (rows.next_row()) {
    TwistSample& twist = twists.emplace_back();
    twist.address = address;
    twist.emission_time_ns = rows.time_ns(0);
    twist.received_time_ns = rows.time_ns(1);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      if (const auto velocity_mps = rows.optional_number(2 + i)) {
        twist.velocity_body_mps[axis] = *velocity_mps;
        twist.velocity_std_mps[axis] = rows.optional_number(5 + i).value_or(-1.0);
        twist.axes |= twist_velocity_x << i;
      }
      if (const auto rate_radps = rows.optional_number(8 + i)) {
        twist.angular_velocity_body_radps[axis] = *rate_radps;
        twist.axes |= twist_angular_velocity_x << i;
      }
    }
  }
  return twists;
}

std::vector<TruthSample> read_truth_csv(const std::filesystem::path& file, BeaconAddress address,
                                        const csv::Layout& layout) {
  csv::Reader rows(file, layout);
  std::vector<TruthSample> samples;
  while (rows.next_row()) {
    if (samples.empty()) samples.reserve(rows.rows_like_this());
    TruthSample& sample = samples.emplace_back();
    sample.address = address;
    sample.time_ns = rows.time_ns(0);
    const auto vector_or_unknown = [&rows](std::size_t column) -> Vector3d {
      return rows.all_filled(column, 3) ? rows.vector(column) : Vector3d::Constant(unknown);
    };
    sample.position_world_m = vector_or_unknown(1);
    sample.q_body_to_world = {unknown, unknown, unknown, unknown};
    if (rows.all_filled(4, 4)) {
      sample.q_body_to_world = {rows.number(4), rows.number(5), rows.number(6), rows.number(7)};
    }
    sample.velocity_world_mps = vector_or_unknown(8);
  }
  return samples;
}

std::vector<WheelSpeed> read_wheel_speed_csv(const std::filesystem::path& file) {
  csv::Reader rows(file, layout_of(wheel_speed_columns, wheel_speed_columns.size()));
  std::vector<WheelSpeed> speeds;
  while (rows.next_row()) {
    const auto speed_mps = rows.optional_number(1);
    if (speed_mps && std::isfinite(*speed_mps)) speeds.push_back({rows.time_ns(0), *speed_mps});
  }
  return speeds;
}

}  // namespace sonopose::recording
