#include "logging/line_limit.hpp"

#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::logging {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_of_word(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

std::string report_of(const std::string& latest, std::uint64_t left_out) {
  if (left_out == 1) return latest;
  return fmt::format("{} ({} not logged)", latest,
                     text::count_text(left_out - 1, "more line like this was", "more lines like this were"));
}

std::string report_of_all(std::uint64_t left_out) {
  return fmt::format("{} not logged: more than {} in a minute",
                     text::count_text(left_out, "line was", "lines were"), LineLimit::max_of_all);
}

}  // namespace

std::string kind_of(std::string_view text) {
  constexpr std::size_t max_bytes = 128;
  std::string kind;
  while (!text.empty() && kind.size() < max_bytes) {
    const auto end = std::find_if_not(text.begin(), text.end(), is_of_word);
    const std::string_view word = text.substr(0, static_cast<std::size_t>(end - text.begin()));
    kind += std::any_of(word.begin(), word.end(), is_digit) ? "#" : word;
    if (word.size() < text.size()) kind += text[word.size()];
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  kind.resize(std::min(kind.size(), max_bytes));
  return kind;
}

bool LineLimit::Count::admits(std::size_t max, Time now) {
  if (lines == 0 || is_over(now)) {
    began = now;
    lines = 0;
  }
  if (lines >= max) {
    ++left_out;
    return false;
  }
  ++lines;
  return true;
}

LineLimit::Kind& LineLimit::kind(const std::string& name, bool is_serious, Time now) {
  const auto known = kinds_.find(name);
  if (known != kinds_.end()) return known->second;
  if (kinds_.size() >= max_kinds) {
    std::erase_if(kinds_, [now](const auto& entry) { return entry.second.count.is_over(now); });
  }
  return kinds_[kinds_.size() < max_kinds ? name : std::string(is_serious ? "!" : "")];
}

void LineLimit::report_due(Time now, std::vector<Admitted>& lines) {
  for (auto& [name, kind] : kinds_) {
    Count& count = kind.count;
    if (count.left_out == 0 || !count.is_over(now)) continue;
    lines.push_back({kind.level, report_of(kind.latest, count.left_out)});
    // The report is the only line of this window, unless there were none in a whole one.
    const bool was_quiet = now - count.began >= 2 * window;
    count = {.began = now, .lines = was_quiet ? 0 : max_of_beacons, .left_out = 0};
  }
  for (Count& all : all_) {
    if (all.left_out == 0 || !all.is_over(now)) continue;
    lines.push_back({Level::warning, report_of_all(std::exchange(all.left_out, 0))});
  }
}

std::vector<LineLimit::Admitted> LineLimit::admitted(Level level, std::string_view text, Time now) {
  std::vector<Admitted> lines;
  report_due(now, lines);
  if (level != Level::debug && level != Level::failure) {
    const std::string name = kind_of(text);
    const bool is_serious = level != Level::info;
    Kind& of = kind(name, is_serious, now);
    if (!of.count.admits(name.starts_with("beacon #") ? max_of_beacons : max_of_kind, now)) {
      of.level = level;
      of.latest = text.substr(0, max_latest_bytes);
      return lines;
    }
    if (!all_[is_serious ? 1 : 0].admits(max_of_all, now)) return lines;
  }
  lines.push_back({level, std::string(text)});
  return lines;
}

std::vector<LineLimit::Admitted> LineLimit::due(Time now) {
  std::vector<Admitted> lines;
  report_due(now, lines);
  return lines;
}

std::vector<LineLimit::Admitted> LineLimit::finish() {
  std::vector<Admitted> lines;
  for (auto& [name, kind] : kinds_) {
    if (kind.count.left_out == 0) continue;
    lines.push_back({kind.level, report_of(kind.latest, std::exchange(kind.count.left_out, 0))});
  }
  for (Count& all : all_) {
    if (all.left_out == 0) continue;
    lines.push_back({Level::warning, report_of_all(std::exchange(all.left_out, 0))});
  }
  return lines;
}

}  // namespace sonopose::logging
