#pragma once
/// \file
/// Writes a CSV file whose numbers read back to the same bits. Errors name the file.

#include "files/append_file.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::csv {

/// Buffers cells and writes whole lines. Every member throws files::IoError if the file cannot be written,
/// for example on a full disk.
class Writer {
public:
  using Existing = files::AppendFile::Existing;

  /// Opens the file; `separator` separates cells.
  Writer(const std::filesystem::path& file, Existing existing, char separator = ',');
  /// Writes the remaining lines. Call flush() first to detect errors.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Writes a line with `#` before the first name.
  void header(std::span<const std::string_view> columns);

  // Cells of a row, from left to right.
  Writer& integer(std::int64_t value);
  Writer& number(double value);  ///< number with the fewest digits that read back to the same bits
  Writer& number_in(long double unit, double value);  ///< number stored in another unit; see units.hpp
  Writer& known_number(double value);                 ///< number; empty if NaN
  Writer& vector(const Vector3d& value);              ///< three numbers
  Writer& seconds(TimeNs time_ns);                    ///< exact seconds, with nine decimals
  Writer& text(std::string_view value);               ///< unchanged text
  Writer& empty();
  void end_row();

  /// Passes all lines to the operating system.
  void flush();

private:
  void begin_cell();

  files::AppendFile file_;
  std::string lines_;
  char separator_;
  bool in_row_ = false;
};

}  // namespace sonopose::csv
