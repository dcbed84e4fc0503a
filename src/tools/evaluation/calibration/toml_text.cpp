#include "evaluation/calibration/toml_text.hpp"

#include <sonopose/settings/settings_table.hpp>

namespace sonopose::evaluation {

std::string toml_number(double value) {
  std::string text = settings::to_text(value + 0.0);  // 0 instead of -0
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string commented(const std::string& text) {
  std::string result = "# ";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_last = i + 1 == text.size();
    if (c == '\n') {
      result += is_last ? "\n" : "\n# ";
    } else {
      result += (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) ? '?' : c;
    }
  }
  return result;
}

}  // namespace sonopose::evaluation
