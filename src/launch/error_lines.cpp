#include "launch/error_lines.hpp"

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
  kept_.push_back(std::exchange(unfinished_, {}));
  if (kept_.size() <= most_lines) return;
  kept_.pop_front();
  ++dropped_;
}

void ErrorLines::print_kept() {
  if (!unfinished_.empty()) end_line();
  // Standard error may be full or closed: that must not end the caller.
  if (dropped_ > 0) std::fprintf(stderr, "(%zu earlier lines are not shown)\n", dropped_);
  for (const std::string& line : kept_) std::fprintf(stderr, "%s\n", line.c_str());
  kept_.clear();
}

}  // namespace sonopose::launch
