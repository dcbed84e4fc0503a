#pragma once
/// \file
/// Compresses chunks, with zstd or frames of lz4. decompression.hpp reverses it.

#include "mcap/records.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace sonopose::mcap {

/// The name in a file: "", "lz4", "zstd".
std::string_view name_of(Compression compression);

/// Returns empty if there is no such compression.
std::optional<Compression> compression_named(std::string_view name);

/// The CRC-32 of the format (that of zlib and PNG), continued from `before`.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// Compresses successive blocks with the same memory.
class Compressor {
public:
  explicit Compressor(Compression compression);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  [[nodiscard]] Compression compression() const { return compression_; }
  /// Upper limit of the compressed size of `size` bytes.
  [[nodiscard]] std::size_t bound(std::size_t size) const;
  /// Writes to the front of `to`, which has `bound` bytes. Returns the number of bytes written.
  std::size_t compress(std::span<const std::byte> from, std::span<std::byte> to);

private:
  struct Context;
  Compression compression_;
  std::unique_ptr<Context> context_;
};

}  // namespace sonopose::mcap
