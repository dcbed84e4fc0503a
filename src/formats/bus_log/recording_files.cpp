#include "bus_log/recording_files.hpp"

#include "files/error.hpp"
#include "files/missing.hpp"
#include "mcap/byte_source.hpp"
#include "mcap/records.hpp"
#include "recording/log_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

namespace sonopose::bus_log {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& path) {
  std::error_code unknown;  // ignored: reading an inaccessible file gives the reason
  return fs::is_regular_file(path, unknown);
}

/// Removes the digits at the start. Returns them without leading zeros, after their number.
std::pair<std::size_t, std::string_view> take_number(std::string_view& text) {
  std::string_view digits = text.substr(0, text.find_first_not_of("0123456789"));
  text.remove_prefix(digits.size());
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return {digits.size(), digits};
}

bool begins_with_digit(std::string_view text) {
  return !text.empty() && text.front() >= '0' && text.front() <= '9';
}

bool is_before(const fs::path& path, const fs::path& other) {
  const std::string name = path.filename().string();
  const std::string other_name = other.filename().string();
  std::string_view a = name;
  std::string_view b = other_name;
  while (!a.empty() && !b.empty()) {
    if (begins_with_digit(a) && begins_with_digit(b)) {
      const auto number = take_number(a);
      const auto other_number = take_number(b);
      if (number != other_number) return number < other_number;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return std::pair(a.size(), path) < std::pair(b.size(), other);
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

}  // namespace

std::vector<fs::path> mcap_files_in(const fs::path& folder) {
  std::error_code unknown;
  std::vector<fs::path> files;
  if (!fs::is_directory(folder, unknown) || files::is_present(folder / recording::imu_file)) return files;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    if (is_mcap(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files, is_before);
  return files;
}

std::vector<fs::path> recording_files(const std::vector<fs::path>& given) {
  std::vector<fs::path> files;
  for (const fs::path& path : given) {
    std::error_code unknown;
    if (!fs::is_directory(path, unknown)) {
      files.push_back(path);
      continue;
    }
    const auto found = mcap_files_in(path);
    if (found.empty()) throw files::IoError(path.string() + ": has no MCAP file");
    std::ranges::copy(found, std::back_inserter(files));
  }
  return files;
}

bool is_in_mcap(const std::vector<fs::path>& recording) {
  return recording.size() > 1 || is_mcap(recording.front()) || !mcap_files_in(recording.front()).empty();
}

bool is_log_folder(const fs::path& recording) {
  return !is_file(recording) && mcap_files_in(recording).empty();
}

std::string name_of(const std::vector<fs::path>& recording) {
  if (recording.size() == 1) return recording.front().string();
  return fmt::format("{} and {} more", recording.front().string(), recording.size() - 1);
}

}  // namespace sonopose::bus_log
