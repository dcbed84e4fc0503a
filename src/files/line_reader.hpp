#pragma once
/// \file
/// Lines of one text file.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::files {

/// Lines end in \n or \r\n, optional for the last one. A byte order mark is skipped.
class LineReader {
public:
  /// Throws IoError if the file cannot be opened.
  explicit LineReader(const std::filesystem::path& file);

  /// The next line without its line ending, valid until the next call; empty at the end of the file. Throws
  /// IoError if the file cannot be read or a line is longer than 256 KiB.
  std::optional<std::string_view> next();

  /// Number of the last line returned, from 1.
  [[nodiscard]] std::size_t number() const { return number_; }

  /// How many lines the file has if all are as long as this one.
  [[nodiscard]] std::size_t lines_like(std::string_view line) const { return file_size_ / (line.size() + 1); }

private:
  /// Moves the unread bytes to the front and reads more; returns false at the end of the file.
  bool refill();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t file_size_ = 0;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< of the bytes that were read but not returned
  std::size_t end_ = 0;
  std::size_t number_ = 0;
};

}  // namespace sonopose::files
