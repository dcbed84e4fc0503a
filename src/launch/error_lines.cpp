#include "launch/error_lines.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace sonopose::launch {

void ErrorLines::add(std::string_view bytes) {
  for (const char c : bytes) {
    if (c == '\n') {
      end_line();
    } else if (unfinished_.size() < most_columns) {
      unfinished_ += c;
    }
  }
}

void ErrorLines::end_line() {
  std::string line = std::exchange(unfinished_, {});
  if (output_ == ErrorOutput::pass_on) {
    fmt::print(stderr, "{}\n", line);
    return;
  }
  kept_.push_back(std::move(line));
  if (kept_.size() <= most_lines) return;
  kept_.pop_front();
  ++dropped_;
}

void ErrorLines::print_kept() {
  if (!unfinished_.empty()) end_line();
  if (dropped_ > 0) fmt::print(stderr, "({} earlier lines are not shown)\n", dropped_);
  for (const std::string& line : kept_) fmt::print(stderr, "{}\n", line);
  kept_.clear();
}

}  // namespace sonopose::launch
