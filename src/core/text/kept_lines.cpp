#include <sonopose/text/kept_lines.hpp>

#include <utility>

namespace sonopose::text {

void KeptLines::add(std::string_view bytes, const std::function<void(const std::string& line)>& on_line) {
  for (const char byte : bytes) {
    if (byte == '\n') {
      end_line();
      if (on_line) on_line(lines_.back());
    } else if (unfinished_.size() < max_columns) {
      unfinished_ += byte;
    }
  }
}

void KeptLines::end_line() {
  lines_.push_back(std::exchange(unfinished_, {}));
  if (lines_.size() <= max_lines) return;
  lines_.pop_front();
  ++dropped_;
}

std::vector<std::string> KeptLines::take() {
  if (!unfinished_.empty()) end_line();
  std::vector<std::string> lines;
  if (dropped_ > 0) lines.push_back("(" + std::to_string(dropped_) + " earlier lines are not shown)");
  lines.insert(lines.end(), lines_.begin(), lines_.end());
  *this = {};
  return lines;
}

}  // namespace sonopose::text
