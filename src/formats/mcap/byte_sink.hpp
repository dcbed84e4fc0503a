#pragma once
/// \file
/// The destination of a writer's bytes.

#include <cstddef>
#include <cstdint>
#include <span>

namespace sonopose::mcap {

class ByteSink {
public:
  virtual ~ByteSink() = default;

  /// Appends all bytes, or throws files::IoError and has appended none.
  virtual void append(std::span<const std::byte> bytes) = 0;

  /// Reserves space for `byte_count` more bytes, as far as the sink knows. Throws files::IoError if they
  /// do not fit. Earlier reservations stay.
  virtual void reserve(std::uint64_t byte_count) = 0;
};

}  // namespace sonopose::mcap
