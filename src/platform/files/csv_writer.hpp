#pragma once
/// \file
/// Writes a CSV file whose numbers read back to the same bits. Errors name the file.

#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::files {

class AppendFile;

/// Buffers cells and writes whole lines. Every member throws IoError if the file cannot be written, for
/// example on a full disk.
class CsvWriter {
public:
  enum class Existing { refuse, replace };

  /// Opens the file; `separator` separates cells.
  CsvWriter(const std::filesystem::path& file, Existing existing, char separator = ',');
  /// Writes the remaining lines. Call flush() first to detect errors.
  ~CsvWriter();
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;
  CsvWriter(CsvWriter&&) = delete;
  CsvWriter& operator=(CsvWriter&&) = delete;

  /// Writes a line with `#` before the first name.
  void header(std::span<const std::string_view> columns);

  // Cells of a row, from left to right.
  CsvWriter& integer(std::int64_t value);
  CsvWriter& number(double value);  ///< number with the fewest digits that read back to the same bits
  CsvWriter& number_in(long double unit, double value);  ///< number stored in another unit; see units.hpp
  CsvWriter& known_number(double value);                 ///< number; empty if NaN
  CsvWriter& vector(const Vector3d& value);              ///< three numbers
  CsvWriter& seconds(TimeNs time_ns);                    ///< exact seconds, with nine decimals
  CsvWriter& text(std::string_view value);               ///< unchanged text
  CsvWriter& empty();
  void end_row();

  /// Passes all lines to the operating system.
  void flush();

private:
  void begin_cell();

  std::unique_ptr<AppendFile> file_;
  std::string lines_;
  char separator_;
  bool in_row_ = false;
};

}  // namespace sonopose::files
