#include "toml/merge.hpp"

#include "files/append_file.hpp"
#include "files/error.hpp"
#include "files/input_file.hpp"
#include "files/replacement.hpp"
#include "toml/leaves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::toml {
namespace {

/// Returns the text between a line and its newline: nothing or a carriage return.
std::string_view line_end_of(std::string_view line) {
  return line.ends_with('\r') ? "\r" : "";
}

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Reads lines including carriage returns and a byte order mark.
std::vector<std::string> lines_of(const std::filesystem::path& file) {
  const std::string text = files::read_text(file);
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  const bool is_complete = text.empty() || text.ends_with('\n');
  if (!is_complete) lines.back() += line_end_of(lines.front());
  return lines;
}

/// Returns a line without whitespace, comment, carriage return and byte order mark.
std::string condensed(std::string_view line) {
  if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
  std::string text(line.substr(0, line.find('#')));
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
  return text;
}

std::string line_of(const Assignment& assignment, std::string_view line_end) {
  const std::string comment = assignment.comment.empty() ? "" : "  # " + assignment.comment;
  return fmt::format("{} = {}{}{}", assignment.name, assignment.value, comment, line_end);
}

std::string key_of(const Assignment& assignment) {
  return assignment.table + "." + assignment.name;
}

void replace(std::string& line, const Assignment& assignment, const std::filesystem::path& file,
             std::size_t number) {
  if (!condensed(line).starts_with(assignment.name + "=")) {
    throw files::IoError(fmt::format("{}:{}: {} is not a line of its own below [{}], so it is not replaced",
                                     file.string(), number, key_of(assignment), assignment.table));
  }
  line = line_of(assignment, line_end_of(line));
}

void insert(std::vector<std::string>& lines, const Assignment& assignment) {
  const std::string header = "[" + assignment.table + "]";
  const auto table = std::find_if(lines.begin(), lines.end(),
                                  [&](const std::string& line) { return condensed(line) == header; });
  const std::string line_end(lines.empty() ? "" : line_end_of(lines.front()));
  if (table != lines.end()) {
    lines.insert(table + 1, line_of(assignment, line_end));
    return;
  }
  if (!lines.empty()) lines.push_back(line_end);
  lines.push_back(header + line_end);
  lines.push_back(line_of(assignment, line_end));
}

}  // namespace

void merge(const std::filesystem::path& file, std::span<const Assignment> assignments) {
  std::vector<std::string> lines;
  std::vector<Leaf> leaves;
  if (std::filesystem::exists(file)) {
    leaves = read_leaves(file);
    lines = lines_of(file);
  }
  std::vector<const Assignment*> added;
  for (const Assignment& assignment : assignments) {
    const auto leaf = std::find_if(leaves.begin(), leaves.end(),
                                   [&](const Leaf& each) { return each.key == key_of(assignment); });
    if (leaf == leaves.end()) {
      added.push_back(&assignment);
    } else {
      replace(lines.at(leaf->line - 1), assignment, file, leaf->line);
    }
  }
  for (const Assignment* assignment : added) insert(lines, *assignment);
  files::Replacement replacement(file);
  const std::string text = fmt::format("{}\n", fmt::join(lines, "\n"));
  files::AppendFile(replacement.part(), files::AppendFile::Existing::replace)
      .append(std::as_bytes(std::span(text)));
  try {
    read_leaves(replacement.part());
  } catch (const files::IoError& error) {
    if (added.empty())
      throw files::IoError(file.string() + ": not changed, since it would be no TOML: " + error.what());
    throw files::IoError(
        file.string() +
        ": has one of these tables in a form to which no line can be added: " + added.front()->table);
  }
  replacement.commit();
}

}  // namespace sonopose::toml
