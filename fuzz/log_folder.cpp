// Reads a sensor-log folder, and its files as tables. The input is these in sequence, each after a line "==
// NAME".

#include "recording/log_folder.hpp"

#include "recording/attitude_log.hpp"
#include "recording/log_columns.hpp"
#include "recording/log_meta.hpp"
#include "recording/tables.hpp"
#include "sensor_logs.hpp"
#include "support.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

/// The file names; the last two are logs of several beacons.
constexpr std::array<std::string_view, 9> names{recording::imu_file,
                                                recording::ultrasonic_file,
                                                recording::heading_file,
                                                recording::truth_file,
                                                recording::movement_file,
                                                recording::meta_file,
                                                recording::wheel_speed_file,
                                                "7/imu.csv",
                                                "8/imu.csv"};

/// Returns the text of one file; empty if the input lacks it.
std::optional<std::string_view> part_of(std::string_view input, std::string_view name) {
  const std::string title = "== " + std::string(name) + "\n";
  const std::size_t found = input.find(title);
  if (found == std::string_view::npos) return std::nullopt;
  const std::string_view text = input.substr(found + title.size());
  return text.substr(0, text.find("== "));
}

/// Returns true for the form of option names. Other names are read, but never written.
bool is_bare(std::string_view name) {
  return !name.empty() &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '-'; });
}

void check_meta(const std::filesystem::path& folder) {
  static const ScratchFolder written("-meta");
  recording::LogMeta meta;
  if (!accepts<files::IoError>([&] { meta = recording::read_log_meta(folder); })) return;
  std::erase_if(meta.settings, [](const auto& setting) { return !is_bare(setting.first); });
  const auto rewritten = [](const recording::LogMeta& any) {
    recording::write_log_meta(written.path(), any);
    return recording::read_log_meta(written.path());
  };
  const recording::LogMeta once = rewritten(meta);  // TOML lacks a character that a text may have
  promise(once.beacon_address == meta.beacon_address && once.imu_meaning == meta.imu_meaning &&
              rewritten(once) == once,
          "what was written is read");
}

/// Creates the scratch folder, with the subfolders of its files.
const ScratchFolder& scratch() {
  static const ScratchFolder folder;
  for (const std::string_view name : names)
    std::filesystem::create_directories((folder.path() / name).parent_path());
  return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ScratchFolder& folder = scratch();
  const std::string_view input = text_of(data, size);
  for (const std::string_view name : names) {
    const auto text = part_of(input, name);
    if (text) {
      std::ignore = folder.write(name, *text);
    } else {
      std::filesystem::remove(folder.path() / name);
    }
  }
  accepts<files::IoError>([&] { check_log(recording::read_sensor_log(folder.path()), size); });
  check_meta(folder.path());
  accepts<files::IoError>([&] { recording::read_attitude_log(folder.path()); });
  accepts<files::IoError>([&] { recording::read_imu_log(folder.path()); });
  accepts<files::IoError>([&] {
    csv::ColumnNames columns;
    const recording::TableFiles tables{.imu = folder.path() / recording::imu_file,
                                       .positions = folder.path() / recording::ultrasonic_file,
                                       .truth = {}};
    check_log(recording::read_tables(tables, columns, 7).log, size);
  });
  return 0;
}
