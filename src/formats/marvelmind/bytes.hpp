#pragma once
/// \file
/// Reads and writes little-endian numbers byte by byte, for any alignment and any host.

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace sonopose::marvelmind {

/// Reads consecutive numbers. The caller checks the length once, beforehand.
class ByteReader {
public:
  explicit constexpr ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  constexpr std::size_t remaining() const { return bytes_.size() - position_; }
  constexpr void skip(std::size_t count) { position_ += count; }

  template <std::integral T>
  constexpr T read() {
    std::make_unsigned_t<T> value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value = static_cast<std::make_unsigned_t<T>>(
          value | (static_cast<std::uint64_t>(bytes_[position_ + i]) << (8 * i)));
    }
    position_ += sizeof(T);
    return static_cast<T>(value);
  }

  /// Reads `N` numbers of the wire's type `Wire`, such as x, y, z.
  template <std::integral Wire, std::size_t N>
  constexpr std::array<Wire, N> read_array() {
    std::array<Wire, N> values{};
    for (Wire& value : values) value = read<Wire>();
    return values;
  }

private:
  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

/// Writes consecutive numbers into a buffer that is large enough.
class ByteWriter {
public:
  explicit constexpr ByteWriter(std::span<std::uint8_t> bytes) : bytes_(bytes) {}

  constexpr std::size_t position() const { return position_; }

  template <std::integral T>
  constexpr void write(T value) {
    const auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_[position_ + i] =
          static_cast<std::uint8_t>((static_cast<std::uint64_t>(bits) >> (8 * i)) & 0xFFU);
    }
    position_ += sizeof(T);
  }

  template <std::integral T, std::size_t N>
  constexpr void write_array(const std::array<T, N>& values) {
    for (const T value : values) write(value);
  }

  /// Writes reserved bytes.
  constexpr void zeros(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) write<std::uint8_t>(0);
  }

private:
  std::span<std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

}  // namespace sonopose::marvelmind
