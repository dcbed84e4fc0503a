#include <sonopose/text/escaped.hpp>
#include <sonopose/text/hexadecimal.hpp>

#include <array>
#include <span>

namespace sonopose::text {

namespace {

/// The character at the start of a text.
struct Character {
  std::size_t bytes = 1;
  bool is_shown = false;  ///< no control character, does not break the line, and in UTF-8
  char32_t code = 0;
  bool is_utf8 = false;
};

/// True for a character that ends a line, or changes the direction of its text.
constexpr bool breaks_line(char32_t code) {
  return code == 0x061c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

Character first_of(std::string_view text) {
  constexpr char32_t erase = 0x7f;
  constexpr char32_t last_of_c1 = 0x9f;
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return {1, lead >= ' ' && lead != erase, lead, true};
  const std::size_t bytes = lead < 0xc0 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : lead < 0xf8 ? 4 : 1;
  if (bytes == 1 || bytes > text.size()) return {};
  char32_t code = lead & (0x7fU >> bytes);
  for (const char each : text.substr(1, bytes - 1)) {
    const auto byte = static_cast<unsigned char>(each);
    if ((byte & 0xc0U) != 0x80) return {};
    code = (code << 6U) | (byte & 0x3fU);
  }
  constexpr std::array<char32_t, 5> min_codes{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  if (code < min_codes.at(bytes) || code > 0x10ffff || is_surrogate) return {};
  return {bytes, code > last_of_c1 && !breaks_line(code), code, true};
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const Character next = first_of(text);
    for (const char& each : text.substr(0, next.bytes)) {
      clean += next.is_shown ? std::string(1, each) : "\\x" + hexadecimal(std::as_bytes(std::span(&each, 1)));
    }
    text.remove_prefix(next.bytes);
  }
  return clean;
}

std::string printable(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const Character next = first_of(text);
    if (next.is_shown || text.front() == '\n' || text.front() == '\t') {
      clean += text.substr(0, next.bytes);
    } else if (next.is_utf8) {
      clean += "\\u";
      for (const unsigned shift : {12U, 8U, 4U, 0U}) clean += digits[(next.code >> shift) & 0xfU];
    } else {
      clean += "\xef\xbf\xbd";  // U+FFFD
    }
    text.remove_prefix(next.bytes);
  }
  return clean;
}

}  // namespace sonopose::text
