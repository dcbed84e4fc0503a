#include "recorder/earlier_files.hpp"

#include "files/error.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace sonopose::recorder {
namespace {

bool is_digit(char character) {
  return std::isdigit(static_cast<unsigned char>(character)) != 0;
}

/// True for a number with at least three digits, as a series has.
bool is_number(std::string_view text) {
  return text.size() >= 3 && (text.size() == 3 || text.front() != '0') &&
         std::all_of(text.begin(), text.end(), is_digit);
}

/// True if the texts are equal, or differ in digits alone.
bool are_alike(std::string_view a, std::string_view b, bool with_any_digits) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) {
    return x == y || (with_any_digits && is_digit(x) && is_digit(y));
  });
}

/// True if `name` is STEM_NUMBER.EXT of the file.
bool is_numbered_name(const std::filesystem::path& name, const std::filesystem::path& file,
                      bool of_any_time) {
  const std::string stem = name.stem().string();
  const std::size_t number = stem.rfind('_');
  return number != std::string::npos && name.extension() == file.extension() &&
         is_number(std::string_view(stem).substr(number + 1)) &&
         are_alike(std::string_view(stem).substr(0, number), file.stem().string(), of_any_time);
}

}  // namespace

std::deque<RecordedFile> find_earlier_files(const std::filesystem::path& file, bool of_any_time) {
  namespace fs = std::filesystem;
  std::vector<std::pair<fs::file_time_type, RecordedFile>> found;
  std::error_code error;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  fs::directory_iterator entries(folder, error);
  if (error) throw files::IoError(folder.string() + ": cannot be listed: " + error.message());
  for (const fs::directory_entry& entry : entries) {
    fs::path name = entry.path().filename();
    const bool is_part = name.extension() == ".part";
    if (is_part) name = name.stem();
    if (!is_numbered_name(name, file, of_any_time) || !entry.is_regular_file(error)) continue;
    const auto bytes = entry.file_size(error);
    if (error) continue;  // removed meanwhile
    const auto written = entry.last_write_time(error);
    if (is_part && fs::file_time_type::clock::now() - written < std::chrono::minutes(1)) continue;
    if (!error) found.emplace_back(written, RecordedFile{entry.path(), bytes});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first, a.second.file) < std::pair(b.first, b.second.file);
  });
  std::deque<RecordedFile> files;
  for (auto& each : found) files.push_back(std::move(each.second));
  return files;
}

}  // namespace sonopose::recorder
