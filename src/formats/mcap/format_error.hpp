#pragma once
/// \file
/// The error for a file that breaks the format.

#include "files/error.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::mcap {

/// A violation of the format. The message names file, byte, record, field, value and limit.
class FormatError : public files::IoError {
public:
  using files::IoError::IoError;
};

/// The place of a record.
struct Place {
  std::string_view file;
  std::uint64_t offset = 0;  ///< offset of the record in the file, or in the records of its chunk
  std::optional<std::uint64_t> chunk_offset;  ///< offset of the chunk that contains the record

  /// "FILE: byte 8", or "FILE: byte 12 of the chunk at byte 8".
  [[nodiscard]] std::string text() const;
  [[noreturn]] void fail(const std::string& what) const;
};

}  // namespace sonopose::mcap
