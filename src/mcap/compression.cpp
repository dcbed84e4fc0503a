#include "mcap/compression.hpp"

#include <algorithm>
#include <lz4frame.h>
#include <new>
#include <stdexcept>
#include <string>
#include <zlib.h>
#include <zstd.h>

namespace sonopose::mcap {

namespace {

/// Fast: a recorder runs next to what it records.
constexpr int zstd_level = 1;

constexpr std::size_t first_growth_bytes = 64U << 10U;

LZ4F_preferences_t lz4_preferences() {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockSizeID = LZ4F_max1MB;
  return preferences;
}

/// Room behind what `to` has: twice as much as before, up to the limit and one byte, which shows that it is
/// exceeded.
std::span<std::byte> grow(std::vector<std::byte>& to, std::size_t used, std::size_t limit) {
  if (used == to.size()) to.resize(std::min(limit + 1, std::max(2 * used, first_growth_bytes)));
  return std::span(to).subspan(used);
}

/// `step` decompresses from the front of both spans and shortens them; it returns whether the stream has
/// ended, or empty if the bytes are invalid.
template <class Step>
Decompressed decompress_steps(std::span<const std::byte> from, std::size_t limit, std::vector<std::byte>& to,
                              const Step& step) {
  to.clear();
  std::size_t used = 0;
  for (;;) {
    const std::span<std::byte> room = grow(to, used, limit);
    std::span<std::byte> rest = room;
    const std::size_t unread = from.size();
    const std::optional<bool> ended = step(from, rest);
    const std::size_t written = room.size() - rest.size();
    used += written;
    if (used > limit) return Decompressed::too_long;
    const bool is_stuck = written == 0 && unread == from.size();
    if (!ended || *ended || is_stuck || (from.empty() && !rest.empty())) {
      to.resize(used);
      if (!ended) return Decompressed::invalid;
      if (!*ended) return Decompressed::cut;
      return from.empty() ? Decompressed::complete : Decompressed::invalid;
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

std::string_view name_of(Compression compression) {
  switch (compression) {
    case Compression::none:
      return "";
    case Compression::lz4:
      return "lz4";
    case Compression::zstd:
      return "zstd";
  }
  return "";
}

std::optional<Compression> compression_named(std::string_view name) {
  for (const Compression compression : {Compression::none, Compression::lz4, Compression::zstd}) {
    if (name_of(compression) == name) return compression;
  }
  return std::nullopt;
}

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

struct Compressor::Context {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd{nullptr, ZSTD_freeCCtx};
  LZ4F_preferences_t lz4 = lz4_preferences();
};

Compressor::Compressor(Compression compression)
    : compression_{compression}, context_{std::make_unique<Context>()} {
  if (compression_ != Compression::zstd) return;
  context_->zstd.reset(ZSTD_createCCtx());
  if (!context_->zstd) throw std::bad_alloc();
}

Compressor::~Compressor() = default;

std::size_t Compressor::bound(std::size_t size) const {
  switch (compression_) {
    case Compression::none:
      return size;
    case Compression::lz4:
      return LZ4F_compressFrameBound(size, &context_->lz4);
    case Compression::zstd:
      return ZSTD_compressBound(size);
  }
  return size;
}

std::size_t Compressor::compress(std::span<const std::byte> from, std::span<std::byte> to) {
  std::size_t size = from.size();
  switch (compression_) {
    case Compression::none:
      std::copy(from.begin(), from.end(), to.begin());
      return size;
    case Compression::lz4:
      size = LZ4F_compressFrame(to.data(), to.size(), from.data(), from.size(), &context_->lz4);
      if (LZ4F_isError(size) != 0) throw std::runtime_error(std::string("lz4: ") + LZ4F_getErrorName(size));
      return size;
    case Compression::zstd:
      size =
          ZSTD_compressCCtx(context_->zstd.get(), to.data(), to.size(), from.data(), from.size(), zstd_level);
      if (ZSTD_isError(size) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
      return size;
  }
  return size;
}

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
