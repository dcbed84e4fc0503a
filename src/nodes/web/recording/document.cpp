#include "web/recording/document.hpp"

#include "web/live/event_json.hpp"
#include "web/live/rows.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace sonopose::web::recording {
namespace {

/// Limits for one beacon, and for all of them: a screen needs no more, and the page would be slow.
constexpr std::size_t max_rows_of_beacon = 20'000;
constexpr std::size_t max_rows_of_all = 200'000;
constexpr TimeNs min_pose_period_ns = 40'000'000;
constexpr TimeNs second_ns = 1'000'000'000;

/// Longest time between a pose with a change and the fusion's log line about it.
constexpr double logged_within_s = 3.0;

/// Drawn values of a status: V, s.
constexpr std::array<std::string_view, 2> status_columns{"battery", "delay"};

/// The names in front, then the columns.
std::vector<std::string_view> names(std::vector<std::string_view> front,
                                    std::span<const std::string_view> columns) {
  front.insert(front.end(), columns.begin(), columns.end());
  return front;
}

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

/// True if a line starts with "beacon N" of another beacon.
bool is_of_another_beacon(std::string_view line_text, BeaconAddress beacon) {
  constexpr std::string_view prefix = "beacon ";
  if (!line_text.starts_with(prefix)) return false;
  line_text.remove_prefix(prefix.size());
  unsigned address = beacon;
  std::from_chars(line_text.data(), line_text.data() + line_text.size(), address);
  return address != beacon;
}

}  // namespace

Columns::Columns(std::vector<std::string_view> names, TimeNs begin_ns, TimeNs min_period_ns)
    : names_(std::move(names)),
      columns_(names_.size() + 1),
      begin_ns_(begin_ns),
      min_period_ns_(min_period_ns),
      next_ns_(std::numeric_limits<TimeNs>::min()) {}

void Columns::add(TimeNs time_ns, std::span<const double> values) {
  if (time_ns < next_ns_) return;
  next_ns_ = saturated_sum(time_ns, min_period_ns_);
  columns_[0].push_back(seconds_between(begin_ns_, time_ns));
  for (std::size_t i = 0; i < values.size(); ++i) columns_[i + 1].push_back(values[i]);
}

std::string Columns::json(std::size_t max_rows) const {
  const std::size_t step = std::max<std::size_t>(1, (size() + max_rows - 1) / max_rows);
  std::string text = "{";
  const auto append = [&text, step](std::string_view name, const std::vector<double>& values) {
    const bool is_time = name == "t" || name == "t_emission";  // 0.1 ms matters, also after hours
    fmt::format_to(std::back_inserter(text), "{}\"{}\":[", text.size() > 1 ? "," : "", name);
    for (std::size_t i = 0; i < values.size(); i += step) {
      if (i > 0) text += ',';
      if (!std::isfinite(values[i])) {
        text += "null";
      } else if (is_time) {
        fmt::format_to(std::back_inserter(text), "{:.4f}", values[i]);
      } else {
        fmt::format_to(std::back_inserter(text), "{:.7g}", values[i]);
      }
    }
    text += ']';
  };
  append("t", columns_[0]);
  for (std::size_t i = 0; i < names_.size(); ++i) append(names_[i], columns_[i + 1]);
  return text + '}';
}

Document::Beacon::Beacon(BeaconAddress address, TimeNs begin_ns, TimeNs min_period_ns)
    : poses(names({}, live::pose_columns), begin_ns, std::max(min_period_ns, min_pose_period_ns)),
      fixes(names({"t_emission"}, live::fix_columns), begin_ns, min_period_ns),
      truth(names({}, live::truth_columns), begin_ns, std::max(min_period_ns, min_pose_period_ns)),
      status(names({status_columns.begin(), status_columns.end()}, observation::latency_segment_names),
             begin_ns, min_period_ns),
      detector(address) {}

Document::Document(double duration_s, std::optional<BeaconAddress> beacon)
    : min_period_ns_(to_ns(duration_s / static_cast<double>(max_rows_of_beacon))),
      beacon_(beacon),
      transition_log_([this](const transitions::LogText& line) {
        keep(changes_, {now_ns_, 1, std::string(transitions::change_of(line.text)),
                        live::event_json(now_ns_, live::word_of(line.level), line.text).dump()});
      }) {}

Document::Beacon& Document::beacon(BeaconAddress address, TimeNs time_ns) {
  if (beacons_.empty()) begin_ns_ = end_ns_ = time_ns;
  end_ns_ = std::max(end_ns_, time_ns);
  return beacons_.try_emplace(address, address, begin_ns_, min_period_ns_).first->second;
}

void Document::advance(TimeNs now_ns) {
  if (second_end_ns_ && now_ns < *second_end_ns_) return;
  if (second_end_ns_) end_second();
  second_end_ns_ = saturated_sum(now_ns, second_ns);
}

void Document::end_second() {
  for (auto& [address, beacon] : beacons_) {
    if (!beacon.latest_ns) continue;
    const TimeNs time_ns = *std::exchange(beacon.latest_ns, std::nullopt);
    const observation::BeaconView view = observers_[address].take_window(address, time_ns);
    std::vector<double> values{
        view.bridge ? view.bridge->battery_v.value_or(live::unknown) : live::unknown,
        view.estimate && view.estimate->delay_s ? view.estimate->delay_s->value : live::unknown};
    for (const observation::Percentiles& segment : view.segments) values.push_back(segment.p50_s);
    const bool is_known =
        std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    if (is_known) beacon.status.add(time_ns, values);
  }
}

void Document::take(transitions::TransitionQueue& transitions, TimeNs time_ns) {
  now_ns_ = time_ns;
  transition_log_.take(transitions, SteadyTime{time_ns});
}

void Document::add(const FusedPose& pose, std::optional<TimeNs> received_ns) {
  Beacon& beacon = this->beacon(pose.address, pose.time_ns);
  beacon.latest_ns = pose.time_ns;
  if (received_ns) observers_[pose.address].on(pose, *received_ns);
  beacon.poses.add(pose.time_ns, live::pose_row(pose));
  transitions::TransitionQueue transitions;
  beacon.detector.on(pose, transitions);
  take(transitions, pose.time_ns);
}

void Document::add(const FixReport& report) {
  if (report.hypothesis != 0) return;  // poses come from the main hypothesis
  Beacon& beacon = this->beacon(report.address, report.applied_time_ns);
  if (!beacon.reports.accepts(report)) return;
  const auto row = live::fix_row(report);
  std::array<double, 1 + row.size()> values{seconds_between(begin_ns_, report.emission_time_ns)};
  std::copy(row.begin(), row.end(), values.begin() + 1);
  beacon.fixes.add(report.applied_time_ns, values);
  transitions::TransitionQueue transitions;
  beacon.detector.on(report, transitions);
  take(transitions, report.applied_time_ns);
}

void Document::add(const TruthSample& truth) {
  beacon(truth.address, truth.time_ns).truth.add(truth.time_ns, live::truth_row(truth));
}

void Document::add(const StationaryBeacon& beacon) {
  if (beacon.position_world_m) stationary_world_m_[beacon.address] = *beacon.position_world_m;
}

void Document::keep(Events& events, Event event) {
  if (events.size() == max_kept) {
    events.pop_front();
    ++events_left_out_;
  }
  events.push_back(std::move(event));
}

void Document::add(const LogLine& line) {
  const std::uint64_t missing = missing_lines_.before(line);
  if (beacon_ && is_of_another_beacon(line.text, *beacon_)) return;
  // Text of other processes need not be UTF-8.
  keep(log_lines_,
       {line.time_ns, missing > 0 ? 2U : 1U,
        live::is_of_fusion(line) ? std::string(transitions::change_of(line.text)) : "",
        live::event_json(line, missing).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});
}

bool Document::has_poses() const {
  return std::any_of(beacons_.begin(), beacons_.end(),
                     [](const auto& entry) { return entry.second.poses.size() > 0; });
}

std::vector<Document::Event> Document::shown_events() {
  std::multimap<std::string_view, TimeNs> logged;
  for (const Event& line : log_lines_) {
    if (!line.change.empty()) logged.emplace(line.change, line.time_ns);
  }
  const auto is_logged = [&logged](const Event& change) {
    const auto [begin, end] = logged.equal_range(change.change);
    return std::any_of(begin, end, [&](const auto& line) {
      return std::abs(seconds_between(line.second, change.time_ns)) < logged_within_s;
    });
  };
  std::vector<Event> events(log_lines_.begin(), log_lines_.end());
  std::copy_if(changes_.begin(), changes_.end(), std::back_inserter(events),
               [&](const Event& change) { return !is_logged(change); });
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.time_ns < b.time_ns; });
  std::uint64_t left_out = events_left_out_;
  std::size_t lines = 0;
  for (const Event& event : events) lines += event.lines;
  auto first = events.begin();
  while (first != events.end() && lines + (left_out > 0 ? 1 : 0) > live::max_events) {
    lines -= first->lines;
    ++left_out;
    ++first;
  }
  events.erase(events.begin(), first);
  if (left_out > 0 && !events.empty()) {
    const std::string text =
        text::count_text(left_out, "earlier event is", "earlier events are") + " not shown";
    const TimeNs time_ns = events.front().time_ns;
    events.insert(events.begin(), {time_ns, 1, "", live::event_json(time_ns, "info", text).dump()});
  }
  return events;
}

std::string Document::json() {
  transition_log_.finish();
  end_second();
  std::vector<std::string> events;
  for (Event& event : shown_events()) events.push_back(std::move(event.json));
  std::string text = fmt::format(R"({{"begin":{:.4f},"duration":{:.4f},"events":[{}],"stationary":[)",
                                 1e-9 * static_cast<double>(begin_ns_), seconds_between(begin_ns_, end_ns_),
                                 fmt::join(events, ","));
  std::string separator;
  for (const auto& [address, position_m] : stationary_world_m_) {
    text += separator + nlohmann::json{{"a", address},
                                       {"x", number(position_m.x())},
                                       {"y", number(position_m.y())},
                                       {"z", number(position_m.z())}}
                            .dump();
    separator = ",";
  }
  text += R"(],"beacons":[)";
  separator.clear();
  const std::size_t max_rows =
      std::min(max_rows_of_beacon, max_rows_of_all / std::max<std::size_t>(1, beacons_.size()));
  for (const auto& [address, beacon] : beacons_) {
    const std::size_t rows =
        std::max({beacon.poses.size(), beacon.fixes.size(), beacon.truth.size(), beacon.status.size()});
    text +=
        fmt::format(R"({}{{"address":{},"rows":{},"poses":{},"fixes":{},"truth":{},"status":{}}})", separator,
                    address, std::min(max_rows, rows), beacon.poses.json(max_rows),
                    beacon.fixes.json(max_rows), beacon.truth.json(max_rows), beacon.status.json(max_rows));
    separator = ",";
  }
  return text + "]}";
}

}  // namespace sonopose::web::recording
