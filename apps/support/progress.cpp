#include "progress.hpp"

#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <unistd.h>

namespace sonopose::apps {
namespace {

constexpr std::chrono::seconds show_after{2};
constexpr std::chrono::milliseconds redraw_period{100};
constexpr std::size_t bar_columns = 30;

std::string bar(double share) {
  if (!std::isfinite(share)) return {};
  const double done = std::clamp(share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(done * static_cast<double>(bar_columns));
  return fmt::format("[{}{}] {:3.0f} %  ", std::string(filled, '#'), std::string(bar_columns - filled, '.'),
                     100.0 * done);
}

}  // namespace

Progress::Progress() : is_terminal_(::isatty(STDERR_FILENO) != 0), due_(Clock::now() + show_after) {}

Progress::~Progress() {
  clear();
}

void Progress::at(double share, std::string_view what) {
  if (!is_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (now < due_) return;
  due_ = now + redraw_period;
  is_drawn_ = true;
  fmt::print(stderr, "\r\x1b[K{}{:.40}", bar(share), text::escaped(what));
}

void Progress::clear() {
  if (is_drawn_) fmt::print(stderr, "\r\x1b[K");
  is_drawn_ = false;
}

}  // namespace sonopose::apps
