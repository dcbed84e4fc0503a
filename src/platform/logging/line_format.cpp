#include "logging/line_format.hpp"

#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <sys/stat.h>

namespace sonopose::logging {
namespace {

struct Form {
  int priority;           ///< priority as in syslog(3)
  std::string_view word;  ///< word before the text
};

/// The forms in the order of Level.
constexpr std::array<Form, 5> forms{{{7, ""}, {6, ""}, {4, "warning: "}, {3, "error: "}, {3, ""}}};

}  // namespace

Stream stream_of(int descriptor, const char* journal_stream) {
  if (journal_stream == nullptr) return Stream::text;
  struct stat file {};
  if (::fstat(descriptor, &file) != 0) return Stream::text;
  return fmt::format("{}:{}", file.st_dev, file.st_ino) == journal_stream ? Stream::journal : Stream::text;
}

std::string formatted(Stream stream, std::string_view program, Level level, std::string_view text) {
  const Form& form = forms.at(static_cast<std::size_t>(level));
  std::string lines;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text::escaped(text.substr(begin, end - begin));
    if (stream == Stream::journal) lines += fmt::format("<{}>", form.priority);
    if (begin > 0) {
      lines += "  ";
    } else if (stream == Stream::text) {
      lines += fmt::format("{}: {}", program, form.word);
    }
    lines += line + "\n";
    begin = end + 1;
  }
  return lines;
}

}  // namespace sonopose::logging
