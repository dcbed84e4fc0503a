#include "recording/tables.hpp"

#include "csv/missing_columns.hpp"
#include "csv/reader.hpp"
#include "csv/units.hpp"
#include "recording/input_check.hpp"
#include "recording/log_columns.hpp"
#include "recording/log_files.hpp"
#include "recording/merge.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace sonopose::recording {
namespace {

constexpr std::array<std::string_view, 7> position_columns{"timestamp [ns]", "x [m]",       "y [m]", "z [m]",
                                                           "received [ns]",  "quality [%]", "tag"};
constexpr std::size_t position_columns_required = 3;

/// Added while reading, since a table may begin at zero or before.
constexpr TimeNs reading_offset_ns = 1'000'000'000'000'000'000;
constexpr TimeNs first_ns = 1'000'000'000;  ///< first time of tables that begin at zero
constexpr std::size_t max_tags = 64;        ///< most devices in a table

constexpr csv::Layout position_layout() {
  return layout_of(position_columns, position_columns_required);
}

csv::Layout table_of(csv::Layout layout, csv::ColumnNames& names) {
  layout.given_names = &names;
  layout.time_offset_ns = reading_offset_ns;
  return layout;
}

/// The columns of a log's file, and the device of a row.
template <std::size_t count>
constexpr auto with_tag(const std::array<std::string_view, count>& columns) {
  std::array<std::string_view, count + 1> all{};
  std::ranges::copy(columns, all.begin());
  all.back() = "tag";
  return all;
}
constexpr auto imu_table_columns = with_tag(imu_columns);
constexpr auto truth_table_columns = with_tag(truth_columns);

constexpr csv::Layout imu_table_layout() {
  return layout_of(imu_table_columns, imu_columns_without_magnetometer);
}

constexpr csv::Layout truth_table_layout() {
  return layout_of(truth_table_columns, truth_columns_required);
}

/// Number of rows by the device that they name.
std::map<std::string, std::size_t> rows_by_tag(const std::filesystem::path& file, csv::ColumnNames names) {
  static constexpr std::array<std::string_view, 1> tag_column{"tag"};
  std::map<std::string, std::size_t> rows_by_tag;
  csv::Layout layout = layout_of(tag_column, 1);
  layout.given_names = &names;
  try {
    for (csv::Reader rows(file, layout); rows.next_row();) {
      if (!rows.is_empty(0)) ++rows_by_tag[std::string(rows.text(0))];
    }
  } catch (const csv::MissingColumns&) {
    return {};
  } catch (const csv::NoNames&) {
    return {};  // the reader of the other columns says so
  }
  return rows_by_tag;
}

/// Result of looking for the device that --tag names.
struct Choice {
  bool is_found = false;
  std::vector<std::string> refusals{};  ///< errors of tables that have only another device
};

/// The device whose rows are read, if the table has several; else empty. Counts the rows of the others.
/// Numbers of rows are no devices.
std::string chosen_tag(const std::filesystem::path& file, const TableFiles& files,
                       const csv::ColumnNames& names, BeaconAddress address, std::size_t& others,
                       Choice& choice) {
  const auto by_tag = rows_by_tag(file, names);
  if (files.tag.empty() && (by_tag.size() < 2 || by_tag.size() > max_tags)) return {};
  if (by_tag.empty()) return {};
  const std::string own = files.tag.empty() ? std::to_string(address) : files.tag;
  if (!by_tag.contains(own)) {
    std::vector<std::string> listed;
    for (const auto& entry : by_tag) {
      if (listed.size() < max_tags) listed.push_back(entry.first);
    }
    std::string refusal = fmt::format(
        "{}: has rows of the devices {}{}{}", file.string(), fmt::join(listed, ", "),
        by_tag.size() > max_tags ? ", …" : "",
        files.tag.empty() ? "; choose one with --tag" : ", and none of the device \"" + files.tag + "\"");
    if (by_tag.size() > 1) throw files::IoError(refusal);
    choice.refusals.push_back(std::move(refusal));
    return {};
  }
  choice.is_found = true;
  for (const auto& [tag, rows] : by_tag) others += tag == own ? 0 : rows;
  return own;
}

std::vector<UltrasonicFix> read_positions(const std::filesystem::path& file, const csv::Layout& layout,
                                          BeaconAddress address, bool leave_repeated_out, Tables& tables) {
  csv::Reader rows(file, layout);
  tables.has_height = rows.has(3);
  const std::size_t coordinates = tables.has_height ? 3 : 2;
  std::vector<UltrasonicFix> fixes;
  while (rows.next_row()) {
    if (rows.filled(0, 1 + coordinates) != 1 + coordinates) {
      ++tables.rows_without_position;
      continue;
    }
    UltrasonicFix fix;
    fix.address = address;
    fix.emission_time_ns = rows.time_ns(0);
    fix.position_world_m = {rows.number(1), rows.number(2), tables.has_height ? rows.number(3) : 0.0};
    fix.received_time_ns = rows.is_empty(4) ? fix.emission_time_ns : rows.time_ns(4);
    fix.quality_percent = rows.optional_number(5);
    fix.measured_delay_s = seconds_between(fix.emission_time_ns, fix.received_time_ns);
    const bool is_repeated = !fixes.empty() && fixes.back().position_world_m == fix.position_world_m;
    if (leave_repeated_out && is_repeated) {
      ++tables.repeated_positions;
    } else {
      fixes.push_back(fix);
    }
  }
  return fixes;
}

/// Throws if a name is given for a column that no table can have.
void check_own_names(const csv::ColumnNames& names) {
  const std::array layouts{imu_table_layout(), position_layout(), truth_table_layout()};
  for (const auto& [given, own] : names.own_by_given) {
    const auto has_own = [&own = own](const csv::Layout& layout) { return has_column(layout, own); };
    if (std::ranges::any_of(layouts, has_own)) continue;
    std::string columns;
    for (const csv::Layout& layout : layouts) {
      for (const std::string_view column : layout.columns) {
        if (columns.find(column) != std::string::npos) continue;
        columns.append(columns.empty() ? "" : ", ").append(column);
      }
    }
    throw files::IoError(
        fmt::format(R"("{}" (given for the column "{}") is none of the names {})", own, given, columns));
  }
}

/// Throws if no header had a given name.
void check_given_names(const csv::ColumnNames& names) {
  for (const auto& [given, own] : names.own_by_given) {
    if (names.found.contains(given)) continue;
    throw files::IoError(fmt::format(R"(no table has a column "{}" (given as "{}"))", given, own));
  }
}

/// The missing columns of all files.
class MissingInAll {
public:
  /// Calls `read`, and notes the columns that it misses.
  template <class Read>
  void collect(const Read& read) {
    try {
      read();
    } catch (const csv::MissingColumns& error) {
      missing_.emplace(missing_ ? csv::MissingColumns(*missing_, error) : error);
    }
  }

  /// Throws if columns are missing.
  void check() const {
    if (missing_) throw csv::MissingColumns(*missing_);
  }

private:
  std::optional<csv::MissingColumns> missing_;
};

/// The words in a column, if there are several which come again, as the names of devices do.
std::vector<std::string> repeated_words(const std::filesystem::path& file, const std::string& column) {
  static constexpr std::array<std::string_view, 1> word_column{"word"};
  csv::ColumnNames names;
  names.own_by_given = {{column, "word"}};
  csv::Layout layout = layout_of(word_column, 1);
  layout.given_names = &names;
  std::map<std::string, std::size_t> rows_by_word;
  for (csv::Reader rows(file, layout); rows.next_row();) {
    if (rows.is_empty(0)) continue;
    if (csv::parse_number(rows.text(0)) || rows_by_word.size() > max_tags) return {};
    ++rows_by_word[std::string(rows.text(0))];
  }
  std::vector<std::string> words;
  for (const auto& [word, rows] : rows_by_word) {
    if (rows > 1) words.push_back(word);
  }
  return words.size() == rows_by_word.size() && words.size() > 1 ? words : std::vector<std::string>{};
}

/// Warnings about columns that may name the devices of a table.
std::vector<std::string> possible_devices(const csv::ColumnNames& names) {
  std::vector<std::string> texts;
  for (std::size_t reader = 0; reader < names.file_by_reader.size(); ++reader) {
    const std::filesystem::path& file = names.file_by_reader[reader];
    if (names.columns_by_reader[reader].contains("tag")) continue;
    for (const std::string& column : names.unused_by_file.at(file.string()).front()) {
      std::vector<std::string> words;
      try {
        words = repeated_words(file, column);
      } catch (const files::IoError&) {
        continue;  // its name is not as in the header, since it has a unit, or is there twice
      }
      if (words.empty()) continue;
      std::string text =
          fmt::format(R"({}: if the column "{}" names devices ({}), choose one: --column "tag={}" --tag {})",
                      file.string(), column, fmt::join(words, ", "), column, words.front());
      if (std::ranges::find(texts, text) == texts.end()) texts.push_back(std::move(text));
    }
  }
  return texts;
}

/// The columns that no reader of their file has.
std::vector<std::string> unused_columns(const csv::ColumnNames& names) {
  std::vector<std::string> unused;
  for (const auto& [file, by_reader] : names.unused_by_file) {
    for (const std::string& column : by_reader.front()) {
      const bool is_unused = std::ranges::all_of(by_reader, [&](const auto& columns) {
        return std::ranges::find(columns, column) != columns.end();
      });
      if (is_unused) unused.push_back(fmt::format("{}: {}", file, column));
    }
  }
  return unused;
}

/// Throws if no table has the tag that the user names. Adds what could not be chosen to the warnings.
void report_choice(const std::string& tag, const Choice& choice, std::vector<std::string>& warnings) {
  if (!tag.empty() && !choice.is_found) {
    throw files::IoError(choice.refusals.empty()
                             ? "no table has a column that names devices, so there is none for --tag " + tag
                             : choice.refusals.front());
  }
  for (const std::string& refusal : choice.refusals) warnings.push_back(refusal + "; all its rows are read");
}

/// Undoes the offset of reading, and moves all times later if the first is below 1.
void move_times(Tables& tables, std::vector<ImuSample>& imu, std::vector<UltrasonicFix>& fixes) {
  std::vector<std::reference_wrapper<TimeNs>> times;
  for (ImuSample& sample : imu) times.emplace_back(sample.sensor_time_ns);
  for (UltrasonicFix& fix : fixes) times.insert(times.end(), {fix.emission_time_ns, fix.received_time_ns});
  for (TruthSample& sample : tables.log.truth) times.emplace_back(sample.time_ns);
  TimeNs earliest_ns = std::numeric_limits<TimeNs>::max();
  for (const TimeNs time_ns : times) earliest_ns = std::min(earliest_ns, time_ns - reading_offset_ns);
  if (earliest_ns < 1) tables.times_moved_ns = first_ns - earliest_ns;
  for (TimeNs& time_ns : times) time_ns += tables.times_moved_ns - reading_offset_ns;
}

}  // namespace

Tables read_tables(const TableFiles& given_files, csv::ColumnNames& names, BeaconAddress address) {
  check_own_names(names);
  Tables tables;
  tables.position_shift_ns = given_files.position_shift_ns;
  TableFiles files = given_files;
  std::error_code error;
  const bool is_one_file = std::filesystem::equivalent(files.imu, files.positions, error);
  if (is_one_file) files.positions = files.imu;
  ImuTable imu_table;
  std::vector<UltrasonicFix> fixes;
  MissingInAll missing;
  Choice choice;
  const auto table_for = [&](const std::filesystem::path& file, const csv::Layout& layout) {
    csv::Layout table = table_of(layout, names);
    table.last_value = chosen_tag(file, files, names, address, tables.rows_of_other_tags, choice);
    return table;
  };
  missing.collect([&] {
    imu_table = read_imu_table(files.imu, address, table_for(files.imu, imu_table_layout()));
    if (is_one_file) tables.rows_of_other_tags = 0;  // counted again
  });
  missing.collect([&] {
    csv::Layout layout = table_for(files.positions, position_layout());
    layout.time_offset_ns += files.position_shift_ns;
    fixes = read_positions(files.positions, layout, address, is_one_file, tables);
  });
  missing.collect([&] {
    if (!files.truth) return;
    tables.log.truth = read_truth_csv(*files.truth, address, table_for(*files.truth, truth_table_layout()));
    sort_by_time(files.truth->string(), "true poses", tables.log.truth, tables.log.warnings);
  });
  missing.check();
  check_given_names(names);
  report_choice(files.tag, choice, tables.log.warnings);
  std::ranges::move(possible_devices(names), std::back_inserter(tables.log.warnings));
  std::vector<ImuSample>& imu = imu_table.samples;
  tables.rows_without_imu = is_one_file ? imu_table.incomplete_rows : imu_table.rows_without_values;
  if (imu.empty()) {
    throw files::IoError(fmt::format(
        "{}: has no row with IMU values{}", files.imu.string(),
        imu_table.incomplete_rows == 0
            ? ""
            : fmt::format("; {} have only some: join rates and forces by time", imu_table.incomplete_rows)));
  }
  if (fixes.empty()) throw files::IoError(files.positions.string() + ": has no row with a position");
  if (files.truth && tables.log.truth.empty()) throw files::IoError(files.truth->string() + ": has no row");
  tables.unused_columns = unused_columns(names);
  for (const auto& [file, titles] : names.titles_by_file) {
    tables.log.warnings.push_back(fmt::format("{}: not read: {} above the names of the columns", file,
                                              text::count_text(titles, "line")));
  }

  move_times(tables, imu, fixes);
  SensorLog merged = merge_by_availability(files.imu.string(), imu, fixes, {});
  tables.log.address = address;
  tables.log.events = std::move(merged.events);
  std::ranges::move(merged.warnings, std::back_inserter(tables.log.warnings));
  return tables;
}

}  // namespace sonopose::recording
