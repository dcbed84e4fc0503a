#include "monitor/screen_page.hpp"

#include "monitor/estimate_table.hpp"
#include "monitor/order.hpp"
#include "monitor/screen_table.hpp"
#include "monitor/words.hpp"
#include "observation/status_words.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/fix_flag_names.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace sonopose::monitor {
namespace {

using observation::BeaconView;
using terminal::Row;
using terminal::Style;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string fix_words(std::uint32_t flags) {
  std::string words;
  for (const auto& [flag, name] : fix_flag_names) {
    if ((flags & flag) != 0U) words += (words.empty() ? "" : ", ") + std::string(name);
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return words.empty() ? "not used" : words;
}

/// Three numbers, each in nine columns.
std::string vector_text(const Vector3d& vector, int decimals) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) text += fmt::format("{:>9}", number(vector[axis], decimals));
  return text;
}

/// The lines of a page.
class Page {
public:
  explicit Page(std::size_t columns) : columns_(columns) {}

  void add(std::string_view text, Style style = Style::plain) {
    lines_.push_back({{fitted(text, columns_), style}});
  }
  /// Adds a name and its value.
  void add(std::string_view name, const std::string& value, Style style = Style::plain) {
    const std::string start = fitted(fmt::format("  {:<18}", name), columns_);
    lines_.push_back({{start, Style::dim}, {fitted(value, columns_ - columns_of(start)), style}});
  }
  void title(std::string_view text) {
    if (!lines_.empty()) add("");
    add(text, Style::bold);
  }
  /// Adds the lines of a text, each with its newline.
  void add_text(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      add(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
  }

  /// Adds the lines of a text. Longer ones continue on indented lines.
  void add_wrapped(std::string_view text, Style style = Style::plain) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      wrap(text.substr(0, end), style);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  void add_warnings(const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) add_wrapped("  " + warning + "\n", Style::warning);
  }

  std::vector<Row> take() { return std::move(lines_); }

private:
  void wrap(std::string_view text, Style style) {
    std::string line;
    while (!text.empty()) {
      const std::string_view word = text.substr(0, text.find(' ', 1));
      if (!line.empty() && columns_of(line) + columns_of(word) > columns_) {
        add(line, style);
        line = "    ";
      }
      line += word;
      text.remove_prefix(word.size());
    }
    add(line, style);
  }

  std::size_t columns_;
  std::vector<Row> lines_;
};

void add_pose(Page& page, const BeaconView& view) {
  const FusedPose& pose = view.pose;
  const bool known = has_pose(view);
  const Vector3d none = Vector3d::Constant(nan);
  page.title("Pose                        x        y        z");
  page.add("position m", vector_text(known ? pose.position_world_m : none, 3));
  page.add("±", vector_text(known ? position_std_m(pose) : none, 3));
  page.add("velocity m/s", vector_text(known ? pose.velocity_world_mps : none, 3));
  page.add("±", vector_text(known ? velocity_std_mps(pose) : none, 3));
  const double yaw_std_deg = known ? yaw_std_rad(pose) / geometry::radians_per_degree : nan;
  page.add(
      "yaw °",
      fmt::format("{:>9} ± {}, {}", number(known ? heading_deg(pose) : nan, 1), number(yaw_std_deg, 2),
                  view.fusion ? text::count_text(view.fusion->headings, "heading") : "no count of headings"));
  page.add("error m", fmt::format("{:>9} RMS{:>9} at most, against the truth",
                                  number(view.position_error_rms_m.value_or(nan), 3),
                                  number(view.position_error_max_m.value_or(nan), 3)));
}

void add_fixes(Page& page, const BeaconView& view) {
  const bool known = has_pose(view);
  page.title("Fixes                       x        y        z");
  page.add("innovation m",
           vector_text(view.report ? view.report->innovation_world_m : Vector3d::Constant(nan), 3));
  const double test_ratio = view.report ? view.report->test_ratio.value_or(nan) : nan;
  page.add("last fix",
           fmt::format("{}; test ratio {}, weight {}",
                       view.report ? fix_words(view.report->flags) : std::string(unknown),
                       number(test_ratio, 2), number(view.report ? view.report->weight : nan, 2)));
  page.add("trust", number(known ? view.pose.trust : nan, 2));
  page.add("valid fix", number(known ? view.pose.since_valid_fix_s : nan, 2) + " s ago");
  if (view.fusion) {
    page.add("counted", fmt::format("{} used ({} down-weighted), {} rejected ({} too late)",
                                    view.fusion->fixes_used, view.fusion->fixes_down_weighted,
                                    view.fusion->fixes_rejected, view.fusion->fixes_late));
  }
}

void add_beacon(Page& page, const BeaconView& view) {
  const bool known = view.bridge.has_value();
  const BeaconStatus bridge = view.bridge.value_or(BeaconStatus{});
  const auto rate = [known](double rate_hz) { return number(known ? rate_hz : nan, 1); };
  page.title("Beacon and line");
  page.add("battery V", number(bridge.battery_v.value_or(nan), 2));
  page.add("signal dBm", number(bridge.rssi_dbm.value_or(nan), 0));
  page.add("rates Hz",
           fmt::format("{} poses, {} IMU, {} fixes, {} headings", number(view.pose_rate_hz, 1),
                       rate(bridge.imu_rate_hz), rate(bridge.fix_rate_hz), rate(bridge.heading_rate_hz)));
  page.add("clock jitter ms", number(known ? bridge.clock_jitter_s * 1e3 : nan, 2));
}

void add_latency(Page& page, const BeaconView& view) {
  const auto add = [&page](std::string_view name, const observation::Percentiles& percentiles) {
    page.add(name, fmt::format("{:>9}{:>9}", ms(percentiles.p50_s), ms(percentiles.p99_s)));
  };
  page.title("Latency ms                p50      p99");
  constexpr std::array<std::string_view, 4> names{"sensor to bridge", "bridge to fusion", "in the fusion",
                                                  "fusion to here"};
  for (std::size_t i = 0; i < names.size(); ++i) add(names[i], view.segments[i]);
  if (view.worst && std::isnan(view.segments[0].p50_s)) {
    page.add("", "sensor to bridge is not known: the samples have stamps of another time, as of a recording");
  }
  add("bridge to here", view.latency);
  const double worst_s = view.worst ? view.worst->latency_s() : nan;
  page.add("slowest pose", fmt::format("{:>9}", ms(worst_s)));
}

void add_fusions(Page& page, const BeaconView& view) {
  page.title("Fusions");
  if (view.fusions.empty()) page.add("  none", Style::warning);
  for (const FusionStatus& fusion : view.fusions) {
    page.add(
        role_word(fusion.role),
        fmt::format("strength {}, {}{}{}", fusion.strength, text::count_text(fusion.reset_counter, "reset"),
                    fusion.imu_silent ? ", IMU silent" : "", fusion.overloaded ? ", overloaded" : ""));
  }
}

}  // namespace

std::vector<Row> page_of(const BeaconView& view, const std::vector<std::string>& warnings,
                         std::size_t columns) {
  Page page(columns);
  const int severity = severity_of(view);
  const Style style = severity >= bad_severity ? Style::bad : severity > 0 ? Style::warning : Style::good;
  page.add("status", stream_words(view), style);
  page.add("flags", has_pose(view) ? observation::status_words(view.pose.status) : std::string(unknown));
  add_pose(page, view);
  add_fixes(page, view);
  add_beacon(page, view);
  add_latency(page, view);
  add_fusions(page, view);
  page.title("Estimates of the fusion");
  const std::string estimates = estimate_table_of({view});
  page.add_text(estimates.empty() ? fmt::format("  {}\n", unknown) : estimates);
  page.title("Problems since the start or the last clear");
  const std::string problems = problems_of(view);
  page.add_wrapped(problems.empty() ? "  none\n" : problems);
  if (!warnings.empty()) page.title("Warnings");
  page.add_warnings(warnings);
  return page.take();
}

std::vector<Row> wrapped(const std::vector<std::string>& warnings, std::size_t columns) {
  Page page(columns);
  page.add_warnings(warnings);
  return page.take();
}

}  // namespace sonopose::monitor
