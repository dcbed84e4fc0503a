#pragma once
/// \file
/// Decompresses chunks of arbitrary content.

#include "mcap/records.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace sonopose::mcap {

enum class Decompressed {
  complete,
  cut,       ///< bytes end before the compressed stream; what came before was decompressed
  invalid,   ///< no such stream; what came before was decompressed
  too_long,  ///< size above the limit
};

/// Replaces `to` by the decompressed bytes, at most `limit` of them. Several frames are one stream.
/// Bytes that are no frame may follow one that ends at the limit. Memory grows with the decompressed data,
/// not with the size that the stream claims.
Decompressed decompress(Compression compression, std::span<const std::byte> from, std::size_t limit,
                        std::vector<std::byte>& to);

}  // namespace sonopose::mcap
