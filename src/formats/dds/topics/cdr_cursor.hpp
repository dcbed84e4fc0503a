#pragma once
/// \file
/// Reads single values of serialized samples, in either byte order and both versions of CDR (of final types).

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace sonopose::dds::topics {

class CdrCursor {
public:
  /// `bytes` begin with the encapsulation header, and must outlive the cursor.
  explicit CdrCursor(std::span<const std::byte> bytes) : bytes_(bytes) {
    good_ = bytes.size() >= header_size;
    if (!good_) return;
    const auto identifier = std::to_integer<unsigned>(bytes[1]);
    is_little_endian_ = (identifier & 1U) != 0;
    greatest_alignment_ = identifier < first_of_version_2 ? 8 : 4;
  }

  /// Offset of the last number from the start of `bytes`.
  [[nodiscard]] std::size_t offset_of_last() const { return header_size + last_; }
  [[nodiscard]] bool is_little_endian() const { return is_little_endian_; }

  /// False from the first missing value on.
  [[nodiscard]] bool is_good() const { return good_; }

  /// Reads the next number; 0 if it is missing.
  template <std::unsigned_integral Value>
  Value read() {
    const std::size_t alignment = std::min(sizeof(Value), greatest_alignment_);
    at_ = (at_ + alignment - 1) / alignment * alignment;
    last_ = at_;
    std::array<std::byte, sizeof(Value)> raw{};
    if (!take(raw)) return 0;
    if (is_little_endian_ != (std::endian::native == std::endian::little))
      std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Value>(raw);
  }

  /// Reads the next string without its terminating zero; empty if it is missing.
  std::string read_string() {
    const auto length = read<std::uint32_t>();
    good_ = good_ && length > 0 && length <= bytes_.size() - header_size - at_;
    if (!good_) return {};
    const auto text = bytes_.subspan(header_size + at_, length - 1);
    at_ += length;
    return {reinterpret_cast<const char*>(text.data()), text.size()};  // NOLINT(*-reinterpret-cast): text
  }

private:
  static constexpr std::size_t header_size = 4;
  static constexpr unsigned first_of_version_2 = 6;

  bool take(std::span<std::byte> to) {
    good_ = good_ && at_ + to.size() <= bytes_.size() - header_size;
    if (!good_) return false;
    std::memcpy(to.data(), bytes_.data() + header_size + at_, to.size());
    at_ += to.size();
    return true;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;  ///< position after the header, from where alignment counts
  std::size_t last_ = 0;
  std::size_t greatest_alignment_ = 8;
  bool is_little_endian_ = false;
  bool good_ = false;
};

}  // namespace sonopose::dds::topics
