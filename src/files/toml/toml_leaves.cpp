#include "files/toml/toml_leaves.hpp"

#include <fmt/format.h>
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <optional>
#include <type_traits>
#include <utility>

namespace sonopose::files::toml {
namespace {

Value value_of(const ::toml::node& node) {
  if (const auto flag = node.value_exact<bool>()) return *flag;
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  if (const auto real = node.value_exact<double>()) return *real;
  if (auto text = node.value_exact<std::string>()) return *std::move(text);
  return OtherValue{};
}

void append_leaves(const ::toml::table& table, const std::string& prefix, std::vector<Leaf>& leaves) {
  for (const auto& [name, node] : table) {
    std::string key = prefix + std::string(name.str());
    if (const auto* inner = node.as_table()) {
      append_leaves(*inner, key + ".", leaves);
    } else {
      leaves.push_back({std::move(key), value_of(node), node.source().begin.line});
    }
  }
}

}  // namespace

std::vector<Leaf> read_leaves(const std::filesystem::path& file) {
  ::toml::table tree;
  try {
    tree = ::toml::parse_file(file.string());
  } catch (const ::toml::parse_error& error) {
    const auto line = error.source().begin.line;
    throw IoError(line == 0 ? fmt::format("{}: {}", file.string(), error.description())
                            : fmt::format("{}:{}: {}", file.string(), line, error.description()));
  }
  std::vector<Leaf> leaves;
  append_leaves(tree, "", leaves);
  return leaves;
}

std::string text_of(const Value& value) {
  struct Visitor {
    std::string operator()(const OtherValue&) const { return "this value"; }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t whole) const { return std::to_string(whole); }
    std::string operator()(double real) const { return fmt::format("{:#}", real); }
    std::string operator()(const std::string& text) const { return fmt::format("\"{}\"", text); }
  };
  return std::visit(Visitor{}, value);
}

}  // namespace sonopose::files::toml
