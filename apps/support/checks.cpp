#include "checks.hpp"

#include <sonopose/text/size_text.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace sonopose::apps {

Check number_between(double min, double max) {
  const bool open = max == std::numeric_limits<double>::max();
  const std::string range = open ? fmt::format("{} or more", min) : fmt::format("{} - {}", min, max);
  return {[=](const std::string& text) {
            double value = 0.0;
            if (!CLI::detail::lexical_cast(text, value) || std::isnan(value))
              return fmt::format("'{}' is not a number", text);
            const bool good = value >= min && value <= max;
            return good ? std::string() : fmt::format("Value {} not in range [{}]", text, range);
          },
          "[" + range + "]"};
}

Check size_between(double min_bytes, double max_bytes) {
  return {[=](std::string& text) {
            const auto bytes = text::bytes_of(text);
            if (!bytes) {
              return fmt::format("'{}' is not a size, such as 0.5MB, 2GiB or 1000000", text);
            }
            if (*bytes < min_bytes) {
              return fmt::format("'{}' is less than {}, the minimum", text, text::size_text(min_bytes));
            }
            if (*bytes > max_bytes) {
              return fmt::format("'{}' is more than {}, the maximum", text, text::size_text(max_bytes));
            }
            text = fmt::format("{:.0f}", std::floor(*bytes));
            return std::string();
          },
          ""};
}

Check readable_by(std::function<void(const std::string&)> read) {
  return {[read = std::move(read)](const std::string& text) {
            try {
              read(text);
            } catch (const std::exception& error) {
              return std::string(error.what());
            }
            return std::string();
          },
          ""};
}

Check one_of(const std::vector<std::string>& words) {
  return {[words](const std::string& text) {
            const bool is_known = std::ranges::find(words, text) != words.end();
            return is_known ? std::string()
                            : fmt::format("'{}' is not one of {}", text, fmt::join(words, ", "));
          },
          fmt::format("{{{}}}", fmt::join(words, ","))};
}

}  // namespace sonopose::apps
