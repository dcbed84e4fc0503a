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

/// The fastest level, since a recorder competes with the programs that it records.
constexpr int zstd_level = 1;

LZ4F_preferences_t lz4_preferences() {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockSizeID = LZ4F_max1MB;
  return preferences;
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

}  // namespace sonopose::mcap
