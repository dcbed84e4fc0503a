#pragma once
/// \file
/// Where a writer puts its bytes.

#include <cstddef>
#include <cstdint>
#include <span>

namespace sonopose::mcap {

class ByteSink {
public:
  virtual ~ByteSink() = default;

  /// Appends all of the bytes, or throws files::IoError and has then appended none of them.
  virtual void append(std::span<const std::byte> bytes) = 0;

  /// Makes sure that `byte_count` more bytes can be appended, as far as the sink can tell. Throws
  /// files::IoError if they cannot; what was reserved before stays reserved.
  virtual void reserve(std::uint64_t byte_count) = 0;
};

}  // namespace sonopose::mcap
