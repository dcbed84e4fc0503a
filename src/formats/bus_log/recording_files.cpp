#include "bus_log/recording_files.hpp"

#include "files/error.hpp"
#include "files/missing.hpp"
#include "logging/log.hpp"
#include "mcap/byte_source.hpp"
#include "mcap/records.hpp"
#include "recording/log_columns.hpp"
#include "ros2/bag/bag_folder.hpp"
#include "ros2/bag/storage.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <system_error>

namespace sonopose::bus_log {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& path) {
  std::error_code unknown;  // ignored: reading an inaccessible file gives the reason
  return fs::is_regular_file(path, unknown);
}

/// Returns true for a file that begins like MCAP.
bool is_mcap(const fs::path& file) {
  if (!is_file(file)) return false;
  const mcap::FileSource source(file);
  std::array<std::byte, 4> begin{};
  if (source.size() < begin.size()) return false;
  source.read(0, begin);
  return std::ranges::equal(begin, std::as_bytes(std::span(mcap::magic)).first(begin.size()));
}

/// Leaves out files that come again, as by a link to another one. Says so.
std::vector<fs::path> without_repetitions(const std::vector<fs::path>& files) {
  std::vector<fs::path> once;
  for (const fs::path& file : files) {
    std::error_code unknown;
    const auto first = std::ranges::find_if(
        once, [&](const fs::path& other) { return fs::equivalent(file, other, unknown); });
    if (first == once.end()) {
      once.push_back(file);
    } else {
      logging::warning(fmt::format("{}: is {} again, and is read once", file.string(), first->string()));
    }
  }
  return once;
}

std::string reason_without_mcap(const fs::path& folder) {
  if (!files::is_present(folder / recording::imu_file)) return ": has no MCAP file";
  return fmt::format(
      ": is a log folder, which is read alone and has no MCAP file; sonopose-bridge --source log --input {} "
      "plays it",
      folder.string());
}

}  // namespace

std::vector<fs::path> mcap_files_in(const fs::path& folder) {
  std::error_code unknown;
  std::vector<fs::path> files;
  if (!fs::is_directory(folder, unknown) || files::is_present(folder / recording::imu_file)) return files;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    if (is_mcap(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return ::strverscmp(a.filename().c_str(), b.filename().c_str()) < 0;
  });
  return files;
}

namespace {

/// The files of a folder that are its recording.
struct FolderFiles {
  std::vector<fs::path> read{};
  std::vector<std::string> warnings{};  ///< about files that are missing, or not read
};

/// Those that metadata.yaml lists. If none of them is there, all in MCAP, or else those in SQLite.
FolderFiles files_of(const fs::path& folder) {
  const ros2::bag::Metadata metadata = ros2::bag::read_metadata(folder);
  const std::vector<fs::path> in_mcap = mcap_files_in(folder);
  std::vector<fs::path> all = in_mcap;
  std::ranges::copy(ros2::bag::sqlite_files_in(folder), std::back_inserter(all));
  const auto is_listed = [&](const fs::path& file) {
    return std::ranges::find(metadata.files, file.lexically_normal()) != metadata.files.end();
  };
  FolderFiles files{.read = {}, .warnings = metadata.missing};
  std::ranges::copy_if(all, std::back_inserter(files.read), is_listed);
  const bool is_known = !files.read.empty();
  if (!is_known) files.read = in_mcap.empty() ? all : in_mcap;
  for (const fs::path& file : all) {
    if (std::ranges::find(files.read, file) != files.read.end()) continue;
    files.warnings.push_back(fmt::format(
        "{}: is not read, {}", file.string(),
        is_known ? "because metadata.yaml does not list it" : "because there are files in MCAP beside it"));
  }
  return files;
}

}  // namespace

std::vector<fs::path> recording_files(const std::vector<fs::path>& given) {
  std::vector<fs::path> files;
  for (const fs::path& path : given) {
    std::error_code unknown;
    if (!fs::is_directory(path, unknown)) {
      files.push_back(path);
      continue;
    }
    const FolderFiles found = files_of(path);
    for (const std::string& text : found.warnings) logging::warning(text);
    if (found.read.empty()) throw files::IoError(path.string() + reason_without_mcap(path));
    std::ranges::copy(found.read, std::back_inserter(files));
  }
  return without_repetitions(files);
}

std::optional<std::string> fewer_than_listed(const std::vector<fs::path>& recording, std::uint64_t messages) {
  std::uint64_t listed = 0;
  for (const fs::path& path : recording) listed += ros2::bag::read_metadata(path).messages;
  if (messages >= listed) return std::nullopt;
  return fmt::format("{}: has {} of the {} messages that metadata.yaml counts", name_of(recording), messages,
                     listed);
}

bool is_in_sqlite(const std::vector<fs::path>& recording) {
  const fs::path& first = recording.front();
  if (!ros2::bag::is_bag_folder(first)) return ros2::bag::is_sqlite(first);
  const std::vector<fs::path> files = files_of(first).read;
  return files.empty() || ros2::bag::is_sqlite(files.front());
}

bool is_in_mcap(const std::vector<fs::path>& recording) {
  if (is_in_sqlite(recording)) return false;
  return recording.size() > 1 || is_mcap(recording.front()) || !mcap_files_in(recording.front()).empty();
}

bool is_log_folder(const fs::path& recording) {
  return !is_file(recording) && mcap_files_in(recording).empty() && !ros2::bag::is_bag_folder(recording);
}

std::string name_of(const std::vector<fs::path>& recording) {
  return text::first_of(recording.front().string(), recording.size());
}

}  // namespace sonopose::bus_log
