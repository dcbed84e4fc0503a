#include "mcap/decompression.hpp"

#include <algorithm>
#include <lz4frame.h>
#include <memory>
#include <new>
#include <optional>
#include <zstd.h>

namespace sonopose::mcap {

namespace {

constexpr std::size_t first_growth_bytes = 64U << 10U;

/// Returns free space behind the used bytes. Doubles the size, up to the limit plus one byte, which shows
/// that the limit is exceeded.
std::span<std::byte> grow(std::vector<std::byte>& to, std::size_t used, std::size_t limit) {
  if (used == to.size()) to.resize(std::min(limit + 1, std::max(2 * used, first_growth_bytes)));
  return std::span(to).subspan(used);
}

/// Decompresses by steps. `step` shortens both spans from the front. It returns true at the end of a frame,
/// after which the next one may begin, and empty if the bytes are invalid.
template <class Step>
Decompressed decompress_steps(std::span<const std::byte> from, std::size_t limit, std::vector<std::byte>& to,
                              const Step& step) {
  to.clear();
  std::size_t used = 0;
  std::optional<std::size_t> frames_end;  // size of the complete frames
  for (;;) {
    const std::span<std::byte> target = grow(to, used, limit);
    std::span<std::byte> rest = target;
    const std::size_t unread = from.size();
    const std::optional<bool> ended = step(from, rest);
    const std::size_t written = target.size() - rest.size();
    used += written;
    if (used > limit) return Decompressed::too_long;
    const bool is_frame_end = ended && *ended;
    if (is_frame_end) frames_end = used;
    const bool is_stuck = written == 0 && unread == from.size();
    if (!ended || is_stuck || (from.empty() && (is_frame_end || !rest.empty()))) {
      to.resize(used);
      // Compressors may fill up a block with bytes that are no frame.
      const bool is_padding = frames_end == used && used == limit;
      if (is_padding || (is_frame_end && from.empty())) return Decompressed::complete;
      return ended ? Decompressed::cut : Decompressed::invalid;
    }
  }
}

Decompressed decompress_zstd(std::span<const std::byte> from, std::size_t limit, std::vector<std::byte>& to) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  return decompress_steps(from, limit, to, [&](auto& input, auto& output) -> std::optional<bool> {
    ZSTD_inBuffer in{input.data(), input.size(), 0};
    ZSTD_outBuffer out{output.data(), output.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(result) != 0) return std::nullopt;
    input = input.subspan(in.pos);
    output = output.subspan(out.pos);
    return result == 0;
  });
}

Decompressed decompress_lz4(std::span<const std::byte> from, std::size_t limit, std::vector<std::byte>& to) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      created, LZ4F_freeDecompressionContext);
  return decompress_steps(from, limit, to, [&](auto& input, auto& output) -> std::optional<bool> {
    std::size_t read = input.size();
    std::size_t written = output.size();
    const std::size_t result =
        LZ4F_decompress(context.get(), output.data(), &written, input.data(), &read, nullptr);
    if (LZ4F_isError(result) != 0) return std::nullopt;
    input = input.subspan(read);
    output = output.subspan(written);
    return result == 0;
  });
}

Decompressed copy(std::span<const std::byte> from, std::size_t limit, std::vector<std::byte>& to) {
  to.clear();
  if (from.size() > limit) return Decompressed::too_long;
  to.assign(from.begin(), from.end());
  return Decompressed::complete;
}

}  // namespace

Decompressed decompress(Compression compression, std::span<const std::byte> from, std::size_t limit,
                        std::vector<std::byte>& to) {
  switch (compression) {
    case Compression::none:
      return copy(from, limit, to);
    case Compression::lz4:
      return decompress_lz4(from, limit, to);
    case Compression::zstd:
      return decompress_zstd(from, limit, to);
  }
  return Decompressed::invalid;
}

}  // namespace sonopose::mcap
