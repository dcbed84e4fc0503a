#include "marvelmind/foreign_protocol.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace sonopose::marvelmind {
namespace {

using Bytes = std::span<const std::uint8_t>;
using namespace std::string_view_literals;

std::string_view text_of(Bytes bytes) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_printable(char c) {
  return c >= ' ' && c <= '~';
}

/// Returns the name of the NMEA 0183 sentence at the start, such as "GPGGA", if its checksum is right.
std::optional<std::string_view> nmea_sentence(std::string_view text) {
  constexpr std::size_t max_size = 128;  // the standard says 82; some talkers exceed it
  text = text.substr(0, max_size);
  const std::size_t star = text.find('*');
  if (text.front() != '$' || star == std::string_view::npos || star + 2 >= text.size()) return std::nullopt;
  const std::string_view body = text.substr(1, star - 1);
  if (!std::all_of(body.begin(), body.end(), is_printable)) return std::nullopt;
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  unsigned stated = 0;
  const char* const end = text.data() + star + 3;
  const auto read = std::from_chars(end - 2, end, stated, 16);
  if (read.ec != std::errc{} || read.ptr != end || stated != sum) return std::nullopt;
  return body.substr(0, body.find(','));
}

std::string nmea_sentences(std::string_view text) {
  constexpr std::size_t max_names = 3;
  std::vector<std::string_view> names;
  for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$', at + 1)) {
    const auto name = nmea_sentence(text.substr(at));
    const bool is_new = name && std::find(names.begin(), names.end(), *name) == names.end();
    if (is_new && names.size() < max_names) names.push_back(*name);
  }
  std::string list;
  for (const std::string_view name : names) {
    list += (list.empty() ? "$" : ", $") + std::string(name.substr(0, 16));
  }
  return list;
}

/// Returns the size of the whole message at the start; 0 if there is none.
using SizeAtStart = std::size_t (*)(Bytes);

std::uint8_t sum_of(Bytes bytes) {
  return std::accumulate(
      bytes.begin(), bytes.end(), std::uint8_t{0},
      [](std::uint8_t sum, std::uint8_t byte) { return static_cast<std::uint8_t>(sum + byte); });
}

/// Remainder of a division by a polynomial, most significant bit first.
std::uint32_t crc_of(Bytes bytes, std::uint32_t polynomial, unsigned bits) {
  const std::uint32_t top = std::uint32_t{1} << (bits - 1U);
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= std::uint32_t{byte} << (bits - 8U);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & top) != 0U ? (crc << 1U) ^ polynomial : crc << 1U;
  }
  return crc & (top | (top - 1U));
}

bool begins(Bytes bytes, std::string_view start) {
  return text_of(bytes).starts_with(start);
}

std::size_t ubx_size(Bytes bytes) {
  if (bytes.size() < 8 || !begins(bytes, "\xB5\x62"sv)) return 0;
  const std::size_t size = 8U + bytes[4] + std::size_t{bytes[5]} * 256;
  if (bytes.size() < size) return 0;
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (const std::uint8_t byte : bytes.subspan(2, size - 4)) {
    a = static_cast<std::uint8_t>(a + byte);
    b = static_cast<std::uint8_t>(b + a);
  }
  return bytes[size - 2] == a && bytes[size - 1] == b ? size : 0;
}

std::size_t rtcm3_size(Bytes bytes) {
  constexpr std::uint32_t crc24q = 0x864CFB;
  if (bytes.size() < 8 || bytes[0] != 0xD3 || (bytes[1] & 0xFCU) != 0) return 0;
  const std::size_t size = 6U + std::size_t{bytes[1]} * 256 + bytes[2];
  return size >= 8 && size <= bytes.size() && crc_of(bytes.first(size), crc24q, 24) == 0 ? size : 0;
}

std::size_t sbf_size(Bytes bytes) {
  constexpr std::uint32_t ccitt = 0x1021;
  if (bytes.size() < 8 || !begins(bytes, "$@"sv)) return 0;
  const std::size_t size = bytes[6] + std::size_t{bytes[7]} * 256;
  if (size < 8 || size % 4 != 0 || size > bytes.size()) return 0;
  const std::uint32_t stated = bytes[2] + std::uint32_t{bytes[3]} * 256;
  return crc_of(bytes.subspan(4, size - 4), ccitt, 16) == stated ? size : 0;
}

std::size_t xsens_size(Bytes bytes) {
  if (bytes.size() < 5 || !begins(bytes, "\xFA\xFF"sv) || bytes[3] == 0xFF) return 0;
  const std::size_t size = 5U + bytes[3];
  return size <= bytes.size() && sum_of(bytes.subspan(1, size - 1)) == 0 ? size : 0;
}

std::size_t wit_motion_size(Bytes bytes) {
  constexpr std::size_t size = 11;
  const bool is_message = bytes.size() >= size && bytes[0] == 0x55 && (bytes[1] & 0xF0U) == 0x50;
  return is_message && sum_of(bytes.first(size - 1)) == bytes[size - 1] ? size : 0;
}

/// A checksum would need the definitions of the messages; their sequence numbers count instead.
std::size_t mavlink_size(Bytes bytes) {
  if (bytes.size() < 3 || (bytes[0] != 0xFE && bytes[0] != 0xFD)) return 0;
  const bool is_signed = bytes[0] == 0xFD && (bytes[2] & 1U) != 0;
  const std::size_t size = bytes[1] + (bytes[0] == 0xFE ? 8U : 12U) + (is_signed ? 13U : 0U);
  return size <= bytes.size() ? size : 0;
}

bool any_follows(Bytes /*before*/, Bytes /*after*/) {
  return true;
}

bool mavlink_follows(Bytes before, Bytes after) {
  const std::size_t at = before[0] == 0xFE ? 2 : 4;
  return before.size() > at && after.size() > at && after[at] == static_cast<std::uint8_t>(before[at] + 1);
}

struct Protocol {
  std::string_view name;
  SizeAtStart size;
  int min_in_row;  ///< by the bits that a message checks: noise must not have a name
  bool (*follows)(Bytes before, Bytes after) = any_follows;
};

constexpr std::array protocols{
    Protocol{"messages of a u-blox receiver (UBX)", ubx_size, 1},
    Protocol{"corrections for a GNSS receiver (RTCM 3)", rtcm3_size, 1},
    Protocol{"messages of a Septentrio receiver (SBF)", sbf_size, 1},
    Protocol{"messages of an Xsens IMU", xsens_size, 2},
    Protocol{"messages of a WitMotion IMU", wit_motion_size, 4},
    Protocol{"MAVLink messages", mavlink_size, 4, mavlink_follows},
};

bool holds(Bytes bytes, const Protocol& protocol) {
  for (; !bytes.empty(); bytes = bytes.subspan(1)) {
    int in_row = 0;
    const std::uint8_t start = bytes.front();
    Bytes before;
    for (Bytes rest = bytes; in_row < protocol.min_in_row && !rest.empty() && rest.front() == start;
         ++in_row) {
      const std::size_t size = protocol.size(rest);
      if (size == 0 || (in_row > 0 && !protocol.follows(before, rest))) break;
      before = rest.first(size);
      rest = rest.subspan(size);
    }
    if (in_row == protocol.min_in_row) return true;
  }
  return false;
}

std::string kind_of_file(std::string_view text) {
  static constexpr std::array kinds{std::pair{"\x89MCAP"sv, "an MCAP file"},
                                    std::pair{"SQLite format 3"sv, "an SQLite database, as of a ROS 2 bag"},
                                    std::pair{"#ROSBAG"sv, "a ROS 1 bag"},
                                    std::pair{"\x1F\x8B\x08"sv, "a compressed file (gzip)"},
                                    std::pair{"\x28\xB5\x2F\xFD"sv, "a compressed file (zstd)"},
                                    std::pair{"\xFD"
                                              "7zXZ"sv,
                                              "a compressed file (xz)"},
                                    std::pair{"PK\x03\x04"sv, "a compressed file (zip)"},
                                    std::pair{"\xD4\xC3\xB2\xA1"sv, "a capture of a network (pcap)"},
                                    std::pair{"\x0A\x0D\x0D\x0A"sv, "a capture of a network (pcapng)"}};
  for (const auto& [start, kind] : kinds) {
    if (text.starts_with(start)) return kind;
  }
  return {};
}

/// Returns a line of a text. Noise, as of a wrong baud rate, is none: it has many other bytes, or few
/// different ones.
std::string line_of_text(std::string_view text) {
  constexpr std::size_t min_size = 8;
  constexpr std::size_t min_distinct = 5;
  constexpr std::size_t max_quoted = 40;
  constexpr std::size_t min_share_percent = 95;
  const auto is_text = [](char c) { return is_printable(c) || c == '\n' || c == '\r' || c == '\t'; };
  const auto count = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_text));
  if (text.size() < min_size || 100 * count < min_share_percent * text.size()) return {};
  if (std::set<char>(text.begin(), text.end()).size() < min_distinct) return {};
  // The first line may have lost its beginning.
  const std::size_t second = text.find_first_of("\r\n");
  const std::size_t begin = text.find_first_not_of("\r\n\t ", second == std::string_view::npos ? 0 : second);
  std::string line(text.substr(begin == std::string_view::npos ? 0 : begin));
  line.resize(std::min({line.find_first_of("\r\n"), line.size(), max_quoted}));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return !is_printable(c); }, ' ');
  return line;
}

}  // namespace

std::string foreign_protocol(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  if (std::string kind = kind_of_file(text); !kind.empty()) return kind;
  if (const std::string names = nmea_sentences(text); !names.empty()) return "NMEA sentences (" + names + ")";
  for (const Protocol& protocol : protocols) {
    if (holds(bytes, protocol)) return std::string(protocol.name);
  }
  if (const std::string line = line_of_text(text); !line.empty()) return "text such as \"" + line + '"';
  return {};
}

}  // namespace sonopose::marvelmind
