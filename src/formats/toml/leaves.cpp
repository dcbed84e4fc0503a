#include "toml/leaves.hpp"

#include "files/line_reader.hpp"

#include <fmt/format.h>
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>

namespace sonopose::toml {
namespace {

// Limits of recursion. The parser, its tables and append_leaves recurse once per part of a key, and a long
// key would overflow the stack. The parser itself limits nested arrays and inline tables.
constexpr int max_dots_in_line = 32;
constexpr int max_parts_of_key = 16;

/// Limit of a file's size: more than the settings of 1,000 beacons.
constexpr std::size_t max_bytes = 16U << 20U;

[[noreturn]] void refuse_size(const std::filesystem::path& file, const std::string& size) {
  throw files::IoError(
      fmt::format("{}: has {} bytes, the limit of a TOML file is {}", file.string(), size, max_bytes));
}

/// Counts dots that may separate the parts of keys. A row of dots in a comment does not count.
int separators_in(std::string_view line) {
  int count = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '.' && (i == 0 || line[i - 1] != '.')) ++count;
  }
  return count;
}

std::string checked_text(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error && size > max_bytes) refuse_size(file, std::to_string(size));
  std::string text;
  files::LineReader lines(file);
  while (const auto line = lines.next()) {
    if (separators_in(*line) > max_dots_in_line) {
      throw files::IoError(
          fmt::format("{}:{}: the line has more than {} dots, so a key may have too many parts",
                      file.string(), lines.number(), max_dots_in_line));
    }
    text.append(*line).push_back('\n');
    if (text.size() > max_bytes + 1) refuse_size(file, "too many");  // a pipe
  }
  return text;
}

Value value_of(const ::toml::node& node);

/// Returns the words of an array, or nothing if it has anything but numbers and texts.
Value words_of(const ::toml::array& array) {
  Words words;
  for (const ::toml::node& node : array) {
    const Value value = value_of(node);
    if (const auto* const text = std::get_if<std::string>(&value)) {
      words.push_back(*text);
    } else if (node.is_number()) {
      words.push_back(text_of(value));
    } else {
      return OtherValue{};
    }
  }
  return words;
}

Value value_of(const ::toml::node& node) {
  if (const auto flag = node.value_exact<bool>()) return *flag;
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  if (const auto real = node.value_exact<double>()) return *real;
  if (auto text = node.value_exact<std::string>()) return *std::move(text);
  if (const auto* const array = node.as_array()) return words_of(*array);
  return OtherValue{};
}

class LeafCollector {
public:
  explicit LeafCollector(const std::filesystem::path& file) : file_(file) {}

  std::vector<Leaf> collect(const ::toml::table& tree) {
    add(tree, "", 1);
    return std::move(leaves_);
  }

private:
  void add(const ::toml::table& table, const std::string& prefix, int part) {
    for (const auto& [name, node] : table) {
      const auto line = node.source().begin.line;
      std::string key = prefix + std::string(name.str());
      if (part > max_parts_of_key) {
        throw files::IoError(fmt::format("{}:{}: {}: the key has more than {} parts", file_.string(), line,
                                         key, max_parts_of_key));
      }
      if (const auto* inner = node.as_table()) {
        add(*inner, key + ".", part + 1);
      } else {
        leaves_.push_back({std::move(key), value_of(node), line});
      }
    }
  }

  const std::filesystem::path& file_;
  std::vector<Leaf> leaves_;
};

}  // namespace

std::vector<Leaf> read_leaves(const std::filesystem::path& file) {
  ::toml::table tree;
  try {
    tree = ::toml::parse(checked_text(file), file.string());
  } catch (const ::toml::parse_error& error) {
    const auto line = error.source().begin.line;
    throw files::IoError(line == 0 ? fmt::format("{}: {}", file.string(), error.description())
                                   : fmt::format("{}:{}: {}", file.string(), line, error.description()));
  }
  return LeafCollector(file).collect(tree);
}

std::vector<std::filesystem::path> with_drop_ins(const std::filesystem::path& file,
                                                 const std::filesystem::path& except) {
  std::vector<std::filesystem::path> drop_ins;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(file.string() + ".d", error)) {
    if (entry.path().extension() == ".toml" && entry.path() != except) drop_ins.push_back(entry.path());
  }
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory) {
    throw files::IoError(fmt::format("{}.d: {}", file.string(), error.message()));
  }
  std::sort(drop_ins.begin(), drop_ins.end());
  drop_ins.insert(drop_ins.begin(), file);
  return drop_ins;
}

std::vector<std::string> unread_drop_ins(const std::filesystem::path& file) {
  std::vector<std::string> texts;
  std::error_code unknown;  // with_drop_ins reports it
  for (const auto& entry : std::filesystem::directory_iterator(file.string() + ".d", unknown)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || name.find(".toml") != std::string::npos) continue;
    texts.push_back(entry.path().string() + ": not read: the name of a drop-in ends in .toml");
  }
  std::sort(texts.begin(), texts.end());
  return texts;
}

std::string text_of(const Value& value) {
  struct Visitor {
    std::string operator()(const OtherValue&) const { return "this value"; }
    std::string operator()(const Words&) const { return "this array"; }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t whole) const { return std::to_string(whole); }
    std::string operator()(double real) const { return fmt::format("{:#}", real); }
    std::string operator()(const std::string& text) const { return fmt::format("\"{}\"", text); }
  };
  return std::visit(Visitor{}, value);
}

}  // namespace sonopose::toml
