#pragma once
/// \file
/// Reads the lines of a text file.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::files {

/// Reads lines that end in `\n` or `\r\n`, or in `\r` in a file that begins without `\n`; the last one may
/// lack it. Skips the byte order mark of UTF-8.
class LineReader {
public:
  /// Throws IoError as open_input does, and for UTF-16.
  explicit LineReader(const std::filesystem::path& file);

  /// Returns the next line without its line ending, valid until the next call; empty at the end of the file.
  /// Throws IoError if the file cannot be read or a line is longer than 256 KiB.
  std::optional<std::string_view> next();

  /// Number of the last returned line, from 1.
  [[nodiscard]] std::size_t number() const { return number_; }

  /// Estimated number of lines, if all were as long as this one.
  [[nodiscard]] std::size_t lines_like(std::string_view line) const { return file_size_ / (line.size() + 1); }

private:
  /// Moves the unread bytes to the front and reads more. Returns false at the end of the file.
  bool refill();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t file_size_ = 0;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< start of the bytes that were read but not returned
  std::size_t end_ = 0;
  std::size_t number_ = 0;
  char line_end_ = '\n';
};

}  // namespace sonopose::files
