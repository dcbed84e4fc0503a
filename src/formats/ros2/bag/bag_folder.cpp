#include "ros2/bag/bag_folder.hpp"

#include "files/error.hpp"
#include "files/input_file.hpp"
#include "recording/log_columns.hpp"
#include "ros2/bag/storage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <yaml-cpp/yaml.h>

namespace sonopose::ros2::bag {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
  std::error_code unknown;
  return fs::exists(file, unknown);
}

std::string scalar_of(const YAML::Node& node) {
  return node && node.IsScalar() ? node.Scalar() : std::string();
}

/// Files of a recording that are compressed as a whole, and not expanded beside it.
std::vector<fs::path> compressed_in(const fs::path& folder) {
  std::error_code unknown;
  std::vector<fs::path> files;
  if (!fs::is_directory(folder, unknown)) return files;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    fs::path expanded = entry.path();
    if (expanded.extension() != ".zstd" || is_there(expanded.replace_extension())) continue;
    if (expanded.extension() == ".mcap" || expanded.extension() == ".db3") files.push_back(entry.path());
  }
  return files;
}

}  // namespace

std::vector<fs::path> sqlite_files_in(const fs::path& folder) {
  std::error_code unknown;
  std::vector<fs::path> files;
  if (!fs::is_directory(folder, unknown)) return files;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    if (entry.path().extension() == ".db3" && is_sqlite(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return ::strverscmp(a.filename().c_str(), b.filename().c_str()) < 0;
  });
  return files;
}

bool is_bag_folder(const fs::path& folder) {
  if (is_there(folder / recording::imu_file)) return false;
  return is_there(folder / "metadata.yaml") || !sqlite_files_in(folder).empty() ||
         !compressed_in(folder).empty();
}

Metadata read_metadata(const fs::path& folder) {
  const fs::path file = folder / "metadata.yaml";
  Metadata metadata;
  const auto fail_if_compressed = [&](const std::string& cause) {
    for (const fs::path& found : compressed_in(folder)) {
      throw files::IoError(
          fmt::format("{}: is compressed as a whole{}: expand the files with zstd -d {}/*.zstd",
                      found.string(), cause, folder.string()));
    }
  };
  if (!is_there(file)) {
    fail_if_compressed("");
    return metadata;
  }
  try {
    const YAML::Node bag = YAML::Load(files::read_text(file))["rosbag2_bagfile_information"];
    if (!bag || !bag.IsMap()) return metadata;
    if (const YAML::Node count = bag["message_count"];
        count && !YAML::convert<std::uint64_t>::decode(count, metadata.messages)) {
      throw files::IoError(fmt::format("{}, line {}: message_count: '{}' is no number", file.string(),
                                       count.Mark().line + 1, scalar_of(count)));
    }
    std::string mode = scalar_of(bag["compression_mode"]);
    std::ranges::transform(mode, mode.begin(), [](char each) {
      return static_cast<char>(std::tolower(static_cast<unsigned char>(each)));
    });
    for (const YAML::Node& each : bag["relative_file_paths"]) {
      const fs::path listed = scalar_of(each);
      // Early versions list the file with the name of the folder.
      fs::path found = folder / listed;
      if (listed.is_absolute() || !is_there(found)) found = folder / listed.filename();
      if (mode == "file" && found.extension() == ".zstd") found.replace_extension();  // if it was expanded
      if (is_there(found)) {
        metadata.files.push_back(found.lexically_normal());
      } else {
        metadata.missing.push_back(
            fmt::format("{}: lacks {}, which metadata.yaml lists", folder.string(), listed.string()));
      }
    }
    if (mode == "file") {
      fail_if_compressed(
          fmt::format(" (compression_mode {} of metadata.yaml)", scalar_of(bag["compression_mode"])));
    }
    for (const fs::path& found : compressed_in(folder)) {
      metadata.missing.push_back(fmt::format(
          "{}: is compressed as a whole, and is not read: expand it with zstd -d", found.string()));
    }
  } catch (const YAML::Exception& error) {
    throw files::IoError(fmt::format("{}, line {}: {}", file.string(), error.mark.line + 1, error.msg));
  } catch (const fs::filesystem_error& error) {
    throw files::IoError(error.what());
  }
  return metadata;
}

}  // namespace sonopose::ros2::bag
