#pragma once
// The text of IDL files.

#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

/// The file's text with what it includes in front, each file once.
inline std::string idl_text(const std::filesystem::path& file, std::set<std::filesystem::path>& seen) {
  if (!seen.insert(std::filesystem::weakly_canonical(file)).second) return {};
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  const std::string include = "#include \"";
  std::string before;
  std::string own;
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with(include)) {
      own += line + "\n";
      continue;
    }
    const std::string name = line.substr(include.size(), line.find('"', include.size()) - include.size());
    before += idl_text(file.parent_path() / name, seen);
  }
  return before + own;
}

inline std::string idl_text(const std::vector<std::string>& files) {
  std::set<std::filesystem::path> seen;
  std::string text;
  for (const std::string& file : files) text += idl_text(file, seen);
  return text;
}
