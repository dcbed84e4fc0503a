#include <sonopose/text/number_text.hpp>

#include <array>
#include <charconv>
#include <string_view>
#include <system_error>

namespace sonopose::text {

std::string number_text(double value, int decimals) {
  std::array<char, 512> digits{};  // the largest value has 309 digits before the point
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  std::string_view text(digits.data(),
                        error == std::errc{} ? static_cast<std::size_t>(end - digits.data()) : 0);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string_view::npos) text.remove_prefix(1);
  return std::string(text);
}

}  // namespace sonopose::text
