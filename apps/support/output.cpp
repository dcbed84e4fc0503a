#include "output.hpp"

#include <sonopose/text/escaped.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace sonopose::apps {

void print_text(std::string_view text) {
  const std::string clean = text::printable(text);
  std::fwrite(clean.data(), 1, clean.size(), stdout);
}

void flush_output() {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return;
  const std::string reason = errno != 0 ? std::string(": ") + std::strerror(errno) : std::string();
  throw std::runtime_error("the output cannot be written" + reason);
}

}  // namespace sonopose::apps
