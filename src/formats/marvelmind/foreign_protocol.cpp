#include "marvelmind/foreign_protocol.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
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

/// Returns true for a message of u-blox's protocol with a valid checksum at the start.
bool is_ubx(Bytes bytes) {
  constexpr std::size_t header_bytes = 6;
  constexpr std::size_t checksum_bytes = 2;
  if (bytes.size() < header_bytes + checksum_bytes || bytes[0] != 0xB5 || bytes[1] != 0x62) return false;
  const std::size_t size = header_bytes + bytes[4] + std::size_t{bytes[5]} * 256;
  if (bytes.size() < size + checksum_bytes) return false;
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (const std::uint8_t byte : bytes.subspan(2, size - 2)) {
    a = static_cast<std::uint8_t>(a + byte);
    b = static_cast<std::uint8_t>(b + a);
  }
  return bytes[size] == a && bytes[size + 1] == b;
}

/// Returns true for four MAVLink messages in a row: a checksum needs the definitions of the messages.
bool is_mavlink(Bytes bytes) {
  constexpr std::uint8_t start_1 = 0xFE;
  constexpr std::uint8_t start_2 = 0xFD;
  constexpr int min_messages = 4;
  const std::uint8_t start = bytes.front();
  if (start != start_1 && start != start_2) return false;
  for (int message = 0; message < min_messages; ++message) {
    if (bytes.size() < 3 || bytes[0] != start) return false;
    const bool is_signed = start == start_2 && (bytes[2] & 1U) != 0;
    const std::size_t size = bytes[1] + (start == start_1 ? 8U : 12U) + (is_signed ? 13U : 0U);
    if (size > bytes.size()) return false;
    bytes = bytes.subspan(size);
  }
  return true;
}

bool holds(Bytes bytes, bool (*is_at_start)(Bytes)) {
  for (; !bytes.empty(); bytes = bytes.subspan(1)) {
    if (is_at_start(bytes)) return true;
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
  if (holds(bytes, is_ubx)) return "messages of a u-blox receiver (UBX)";
  if (holds(bytes, is_mavlink)) return "MAVLink messages";
  if (const std::string line = line_of_text(text); !line.empty()) return "text such as \"" + line + '"';
  return {};
}

}  // namespace sonopose::marvelmind
