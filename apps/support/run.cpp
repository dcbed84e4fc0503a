#include "run.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>

namespace sonopose::apps {
namespace {

/// A pipe that was closed and a full disk show when the last lines leave the buffer, if not before.
void check_output() {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return;
  const std::string reason = errno != 0 ? std::string(": ") + std::strerror(errno) : std::string();
  throw std::runtime_error("the output cannot be written" + reason);
}

}  // namespace

CLI::Validator number_between(double least, double most) {
  const bool open = most == std::numeric_limits<double>::max();
  const std::string range = open ? fmt::format("{} or more", least) : fmt::format("{} - {}", least, most);
  return {[=](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return good ? std::string() : fmt::format("Value {} not in range [{}]", text, range);
          },
          "[" + range + "]"};
}

int run(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  try {
    const int code = body();
    check_output();
    return code;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return 1;
  }
}

}  // namespace sonopose::apps
