#pragma once
/// \file
/// A file that breaks the format.

#include "files/error.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::mcap {

/// The message names file, byte, record, field, value and limit.
class FormatError : public files::IoError {
public:
  using files::IoError::IoError;
};

/// Where a record is.
struct Place {
  std::string_view file;
  std::uint64_t offset = 0;                   ///< of the record in the file, or in the records of the chunk
  std::optional<std::uint64_t> chunk_offset;  ///< of the chunk that the record is in

  /// "FILE: byte 8", or "FILE: byte 12 of the chunk at byte 8".
  [[nodiscard]] std::string text() const;
  [[noreturn]] void fail(const std::string& what) const;
};

}  // namespace sonopose::mcap
