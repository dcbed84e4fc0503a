#include "config/fusion_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace sonopose::config {

namespace {

const char* title_of(settings::ReadBy engines) {
  switch (engines) {
    case settings::ReadBy::kalman:
      return "Kalman engine";
    case settings::ReadBy::documented:
      return "Documented engine";
    case settings::ReadBy::all:
      break;
  }
  return "Both engines";
}

}  // namespace

std::string settings_page() {
  std::string text =
      "# Settings of the fusion\n\n"
      "Generated from `settings_table.cpp`; a test compares both. Set them in a TOML file "
      "(`--config`;\n"
      "`sonopose-fusion --print-config` prints one) or on the command line (`--set "
      "heading.mount_offset_deg=90`).\n"
      "`beacon.7.` in front applies one to one beacon only. Numbers in parentheses are items of the "
      "[specification](algorithm.md).\n";
  std::string_view title;
  for (const auto& row : settings::setting_table()) {
    if (title != title_of(row.read_by)) {
      title = title_of(row.read_by);
      text += fmt::format("\n## {}\n\n| Key | Default | Allowed | Meaning |\n|---|---|---|---|\n", title);
    }
    const std::string item = row.item == settings::no_item ? "" : fmt::format(" ({})", row.item);
    text += fmt::format("| `{}` | {} | {} | {}{} |\n", row.key, settings::to_text(row.initial), row.allowed(),
                        row.sentence, item);
  }
  return text;
}

std::vector<std::string> settings_groups() {
  std::vector<std::string> groups;
  for (const auto& row : settings::setting_table()) {
    const std::string group = row.key.substr(0, row.key.rfind('.'));
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  return groups;
}

std::string settings_help(const std::string& group) {
  std::string rows;
  for (const auto& row : settings::setting_table()) {
    if (!group.empty() && row.key != group && !row.key.starts_with(group + ".")) continue;
    const std::string item = row.item == settings::no_item ? "" : fmt::format("  item {}", row.item);
    rows += fmt::format("  {:<53}{:<10}{}{}\n", row.key, settings::to_text(row.initial), row.allowed(), item);
  }
  if (rows.empty()) return rows;
  return "Settings for --set, with default and range (--print-config of sonopose-fusion says what they "
         "do):\n" +
         rows;
}

}  // namespace sonopose::config
