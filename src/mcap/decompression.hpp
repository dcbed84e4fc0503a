#pragma once
/// \file
/// The decompression of chunks of any content.

#include "mcap/records.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace sonopose::mcap {

/// What became of compressed bytes.
enum class Decompressed {
  complete,
  cut,       ///< the bytes end before the compressed stream does; what came before was decompressed
  invalid,   ///< not such a stream, or bytes follow it; what came before was decompressed
  too_long,  ///< more than the limit
};

/// Replaces `to` by the decompressed bytes, at most `limit` of them. Memory grows with what is decompressed,
/// not with what the stream claims.
Decompressed decompress(Compression compression, std::span<const std::byte> from, std::size_t limit,
                        std::vector<std::byte>& to);

}  // namespace sonopose::mcap
