#include <sonopose/text/escaped.hpp>
#include <sonopose/text/hexadecimal.hpp>

#include <span>

namespace sonopose::text {

std::string escaped(std::string_view text) {
  constexpr char erase = 127;
  std::string clean;
  for (const char& each : text) {
    const bool is_control = (each >= 0 && each < ' ') || each == erase;
    clean += is_control ? "\\x" + hexadecimal(std::as_bytes(std::span(&each, 1))) : std::string(1, each);
  }
  return clean;
}

}  // namespace sonopose::text
