#include "monitor/screen_table.hpp"

#include "monitor/order.hpp"
#include "monitor/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace sonopose::monitor {
namespace {

using observation::BeaconView;
using terminal::Style;

double of_pose(const BeaconView& view, double value) {
  return has_pose(view) ? value : std::numeric_limits<double>::quiet_NaN();
}

/// Error against the truth, or "±" the standard deviation.
std::string error_text(const BeaconView& view) {
  const std::string text = number(error_m(view), 3);
  return view.position_error_rms_m || text == unknown ? text : "±" + text;
}

struct Column {
  std::string_view title;
  std::size_t width;
  int priority;  ///< smallest first, as long as there is space
  std::string (*text)(const BeaconView& view);
};

constexpr std::array columns_by_position{
    Column{"beacon", 6, 0, [](const BeaconView& view) { return fmt::format("{}", view.address); }},
    Column{"pose Hz", 7, 1, [](const BeaconView& view) { return number(view.pose_rate_hz, 1); }},
    Column{"IMU Hz", 6, 12,
           [](const BeaconView& view) {
             return view.bridge ? number(view.bridge->imu_rate_hz, 1) : std::string(unknown);
           }},
    Column{"fix Hz", 6, 2,
           [](const BeaconView& view) {
             return view.bridge ? number(view.bridge->fix_rate_hz, 1) : std::string(unknown);
           }},
    Column{"x m", 8, 3,
           [](const BeaconView& view) { return number(of_pose(view, view.pose.position_world_m.x()), 2); }},
    Column{"y m", 8, 4,
           [](const BeaconView& view) { return number(of_pose(view, view.pose.position_world_m.y()), 2); }},
    Column{"z m", 7, 9,
           [](const BeaconView& view) { return number(of_pose(view, view.pose.position_world_m.z()), 2); }},
    Column{"yaw °", 6, 8,
           [](const BeaconView& view) { return number(of_pose(view, heading_deg(view.pose)), 1); }},
    Column{
        "m/s", 6, 10,
        [](const BeaconView& view) { return number(of_pose(view, view.pose.velocity_world_mps.norm()), 2); }},
    Column{"error m", 7, 5, error_text},
    Column{"trust", 5, 6, [](const BeaconView& view) { return number(of_pose(view, view.pose.trust), 2); }},
    Column{"fix age s", 9, 13,
           [](const BeaconView& view) { return number(of_pose(view, view.pose.since_valid_fix_s), 2); }},
    Column{"p50 ms", 7, 14, [](const BeaconView& view) { return ms(view.latency.p50_s); }},
    Column{"p99 ms", 7, 7, [](const BeaconView& view) { return ms(view.latency.p99_s); }},
    Column{"lost", 6, 11,
           [](const BeaconView& view) {
             return view.fusion ? fmt::format("{}", view.fusion->events_lost) : std::string(unknown);
           }},
    Column{"missed", 6, 15, [](const BeaconView& view) { return fmt::format("{}", view.deadlines_missed); }},
    Column{"battery V", 9, 16, [](const BeaconView& view) {
             return view.bridge && view.bridge->battery_v ? number(*view.bridge->battery_v, 2)
                                                          : std::string(unknown);
           }}};

constexpr std::size_t gap = 1;
constexpr std::size_t min_status_columns = 12;

/// Visible columns, and the width left for the status.
struct Choice {
  std::array<bool, columns_by_position.size()> shown{};
  std::size_t status_columns = 0;
};

Choice choose(std::size_t columns) {
  std::array<std::size_t, columns_by_position.size()> order{};
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) {
    return columns_by_position[a].priority < columns_by_position[b].priority;
  });
  Choice choice{{}, columns};
  for (const std::size_t i : order) {
    const std::size_t width = columns_by_position[i].width + gap;
    if (choice.status_columns < width + min_status_columns) break;
    choice.shown[i] = true;
    choice.status_columns -= width;
  }
  return choice;
}

/// Text aligned right in its column.
std::string cell(std::string_view text, std::size_t width) {
  const std::string fitting = fitted(text, width);
  return std::string(width - columns_of(fitting), ' ') + fitting;
}

Style style_of(const BeaconView& view) {
  const int severity = severity_of(view);
  if (severity >= bad_severity) return Style::bad;
  return severity > 0 ? Style::warning : Style::good;
}

/// Text padded so that its style reaches the end of the line.
std::string padded(std::string text, std::size_t columns) {
  const std::size_t used = columns_of(text);
  return used < columns ? text.append(columns - used, ' ') : text;
}

}  // namespace

std::string fitted(std::string_view text, std::size_t columns) {
  const bool cut = columns_of(text) > columns;
  const std::size_t kept = cut && columns > 0 ? columns - 1 : columns;
  std::string result;
  std::size_t used = 0;
  for (const char byte : text) {
    if (text::is_first_byte(byte) && ++used > kept) break;
    const auto code = static_cast<unsigned char>(byte);
    result += code < 0x20 || code == 0x7F ? '?' : byte;
  }
  if (cut && columns > 0) result += "…";
  return result;
}

terminal::Row table_heading(std::size_t columns) {
  const Choice choice = choose(columns);
  std::string text;
  for (std::size_t i = 0; i < columns_by_position.size(); ++i) {
    const Column& column = columns_by_position[i];
    if (choice.shown[i]) text += cell(column.title, column.width) + std::string(gap, ' ');
  }
  text += fitted("status", choice.status_columns);
  return {{padded(std::move(text), columns), Style::heading}};
}

terminal::Row table_row(const BeaconView& view, std::size_t columns, bool selected) {
  const Choice choice = choose(columns);
  std::string values;
  for (std::size_t i = 0; i < columns_by_position.size(); ++i) {
    const Column& column = columns_by_position[i];
    if (choice.shown[i]) values += cell(column.text(view), column.width) + std::string(gap, ' ');
  }
  std::string status = padded(fitted(stream_words(view), choice.status_columns), choice.status_columns);
  if (selected) return {{values + status, Style::selected}};
  return {{std::move(values), Style::plain}, {std::move(status), style_of(view)}};
}

}  // namespace sonopose::monitor
