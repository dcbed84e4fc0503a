#include "files/toml/merge.hpp"

#include "files/csv_writer.hpp"
#include "files/line_reader.hpp"
#include "files/replacement.hpp"
#include "files/toml/toml_leaves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace sonopose::files::toml {
namespace {

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::vector<std::string> lines;
  LineReader reader(file);
  while (const auto line = reader.next()) lines.emplace_back(*line);
  return lines;
}

/// Without spaces and tabs, and without a comment.
std::string condensed(std::string_view line) {
  std::string text(line.substr(0, line.find('#')));
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  return text;
}

std::string line_of(const Assignment& assignment) {
  const std::string comment = assignment.comment.empty() ? "" : "  # " + assignment.comment;
  return fmt::format("{} = {}{}", assignment.name, assignment.value, comment);
}

std::string key_of(const Assignment& assignment) {
  return assignment.table + "." + assignment.name;
}

void replace(std::string& line, const Assignment& assignment, const std::filesystem::path& file,
             std::size_t number) {
  if (!condensed(line).starts_with(assignment.name + "=")) {
    throw IoError(fmt::format("{}:{}: {} is not a line of its own below [{}], so it is not replaced",
                              file.string(), number, key_of(assignment), assignment.table));
  }
  line = line_of(assignment);
}

void insert(std::vector<std::string>& lines, const Assignment& assignment) {
  const std::string header = "[" + assignment.table + "]";
  const auto table = std::find_if(lines.begin(), lines.end(),
                                  [&](const std::string& line) { return condensed(line) == header; });
  if (table != lines.end()) {
    lines.insert(table + 1, line_of(assignment));
    return;
  }
  if (!lines.empty()) lines.emplace_back();
  lines.push_back(header);
  lines.push_back(line_of(assignment));
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
  Replacement replacement(file);
  {
    CsvWriter out(replacement.part(), CsvWriter::Existing::replace);
    out.text(fmt::format("{}\n", fmt::join(lines, "\n")));
    out.flush();
  }
  try {
    read_leaves(replacement.part());
  } catch (const IoError& error) {
    if (added.empty())
      throw IoError(file.string() + ": not changed, since it would be no TOML: " + error.what());
    throw IoError(file.string() + ": has one of these tables in a form to which no line can be added: " +
                  added.front()->table);
  }
  replacement.commit();
}

}  // namespace sonopose::files::toml
