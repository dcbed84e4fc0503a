#pragma once
/// \file
/// Lines of one text file. Private to this room.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::files {

/// Lines end in \n or \r\n; the last one need not, and a byte order mark is no part of the first.
class LineReader {
public:
  /// Throws IoError where the file cannot be opened.
  explicit LineReader(const std::filesystem::path& file);

  /// The next line without its end, valid until the next call; empty at the end of the file. Throws IoError
  /// where the file cannot be read, or where a line is longer than any of a text file.
  std::optional<std::string_view> next();

  /// Of the line that was given last, from 1.
  [[nodiscard]] std::size_t number() const { return number_; }

  /// How many lines the file would have if all were as long as this one.
  [[nodiscard]] std::size_t lines_like(std::string_view line) const { return file_size_ / (line.size() + 1); }

private:
  /// Moves what is left to the buffer's begin and fills up behind it; false where the file has no more.
  bool refill();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t file_size_ = 0;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< of what has been read and not given out
  std::size_t end_ = 0;
  std::size_t number_ = 0;
};

}  // namespace sonopose::files
