#include "ros2/bag/message_definition.hpp"

#include "json/json.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <map>
#include <type_traits>
#include <utility>

namespace sonopose::ros2::bag {
namespace {

using Kind = MessageDefinition::Kind;
using Repetition = MessageDefinition::Repetition;
using Field = MessageDefinition::Field;
using Type = MessageDefinition::Type;

constexpr std::array<std::pair<std::string_view, Kind>, 14> primitives{{{"bool", Kind::boolean},
                                                                        {"byte", Kind::uint8},
                                                                        {"char", Kind::uint8},
                                                                        {"int8", Kind::int8},
                                                                        {"uint8", Kind::uint8},
                                                                        {"int16", Kind::int16},
                                                                        {"uint16", Kind::uint16},
                                                                        {"int32", Kind::int32},
                                                                        {"uint32", Kind::uint32},
                                                                        {"int64", Kind::int64},
                                                                        {"uint64", Kind::uint64},
                                                                        {"float32", Kind::float32},
                                                                        {"float64", Kind::float64},
                                                                        {"string", Kind::string}}};

constexpr std::string_view spaces = " \t\r";

/// Removes the first word from a line, and returns it.
std::string_view take_word(std::string_view& line, std::string_view ends = spaces) {
  line.remove_prefix(std::min(line.find_first_not_of(spaces), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(ends));
  line.remove_prefix(word.size());
  line.remove_prefix(std::min(line.find_first_not_of(spaces), line.size()));
  return word;
}

std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line;
}

/// "pkg/msg/Name" → "pkg/Name".
std::string short_name(std::string_view type) {
  const std::size_t first = type.find('/');
  const std::size_t last = type.rfind('/');
  if (first == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, first)) + std::string(type.substr(last));
}

std::string package_of(std::string_view short_type) {
  return std::string(short_type.substr(0, short_type.find('/') + 1));
}

/// A field whose type is not resolved yet.
struct NamedField {
  Field field;
  std::string type;
};
using NamedTypes = std::map<std::string, std::vector<NamedField>, std::less<>>;

/// Splits "float64[9]" into the type and its repetition. Returns false for an array without elements, whose
/// messages would not end.
bool parse_repetition(std::string_view& type, Field& field) {
  const std::size_t bracket = type.find('[');
  const std::string_view inside = bracket == std::string_view::npos ? "" : type.substr(bracket + 1);
  type = type.substr(0, bracket);
  type = type.substr(0, type.find("<="));  // a bounded string
  if (bracket == std::string_view::npos) return true;
  field.repetition = Repetition::sequence;
  if (inside.starts_with(']') || inside.starts_with("<=")) return true;
  field.repetition = Repetition::array;
  const auto [end, error] = std::from_chars(inside.data(), inside.data() + inside.size(), field.count);
  return error == std::errc() && end != inside.data() + inside.size() && *end == ']' && field.count > 0;
}

/// Parses the line of a field. Empty lines and constants add none. Returns false if it is none of these.
bool parse_line(std::string_view line, std::vector<NamedField>& fields) {
  std::string_view type = take_word(line);
  if (type.empty() || type.starts_with('#')) return true;
  const std::string_view name = take_word(line, " \t\r=#");
  if (line.starts_with('=')) return true;  // a constant
  NamedField named{.field = {.name = std::string(name)}, .type = {}};
  if (!parse_repetition(type, named.field)) return false;
  const auto is_of_name = [](char each) {
    return each == '_' || (each >= '0' && each <= '9') || (each >= 'a' && each <= 'z') ||
           (each >= 'A' && each <= 'Z');
  };
  if (name.empty() || !std::ranges::all_of(name, is_of_name)) return false;
  named.type = type;
  fields.push_back(std::move(named));
  return true;
}

bool is_separator(std::string_view line) {
  const std::string_view word = take_word(line);
  return word.size() > 2 && word.find_first_not_of('=') == std::string_view::npos;
}

std::optional<NamedTypes> parse_types(const std::string& first, std::string_view text) {
  NamedTypes types;
  std::string name = first;
  std::vector<NamedField> fields;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    if (!is_separator(line)) {
      if (!parse_line(line, fields)) return std::nullopt;
      continue;
    }
    types.emplace(std::move(name), std::exchange(fields, {}));
    line = take_line(text);
    if (take_word(line) != "MSG:") return std::nullopt;
    name = short_name(take_word(line));
  }
  types.emplace(std::move(name), std::move(fields));
  return types;
}

/// Finds a part, which may lack the package.
NamedTypes::const_iterator find_type(const NamedTypes& types, const std::string& type,
                                     const std::string& package) {
  if (type.find('/') != std::string::npos) return types.find(short_name(type));
  const auto found = types.find(package + type);
  return found == types.end() && type == "Header" ? types.find("std_msgs/Header") : found;
}

/// Serialized bytes, and the JSON that is made of them. Members return false at bytes that are no message.
class Conversion {
public:
  Conversion(std::span<const std::byte> data, bool is_foreign, const std::vector<Type>& types)
      : data_{data}, is_foreign_{is_foreign}, types_{types} {}

  bool add(const Type& type, int depth = 0) {
    constexpr int max_depth = 64;
    // Names of fields make the text longer than the bytes, but not without limit.
    const std::size_t max_text = (std::size_t{1} << 20U) + 256 * data_.size();
    if (depth > max_depth || text_.size() > max_text) return false;
    if (type.empty()) {  // has a member that no .msg file shows
      text_ += "{}";
      return skip(1);
    }
    char separator = '{';
    for (const Field& field : type) {
      text_ += separator;
      text_ += '"';
      text_ += field.name;
      text_ += "\":";
      if (!add(field, depth)) return false;
      separator = ',';
    }
    text_ += '}';
    return true;
  }

  /// Returns the text, or an empty one if there are more bytes than padding.
  std::string finish() {
    constexpr std::size_t max_padding = 3;
    return data_.size() - at_ > max_padding ? std::string() : std::move(text_);
  }

private:
  bool skip(std::size_t count) {
    if (data_.size() - at_ < count) return false;
    at_ += count;
    return true;
  }

  template <class Value>
  bool read(Value& value) {
    const std::size_t start = (at_ + sizeof value - 1) / sizeof value * sizeof value;
    if (start > data_.size() || data_.size() - start < sizeof value) return false;
    std::array<std::byte, sizeof value> bytes{};
    std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(start), sizeof value, bytes.begin());
    if (is_foreign_) std::ranges::reverse(bytes);
    value = std::bit_cast<Value>(bytes);
    at_ = start + sizeof value;
    return true;
  }

  template <class Value>
  bool add_number() {
    Value value{};
    if (!read(value)) return false;
    if constexpr (std::is_floating_point_v<Value>) {
      json::append_real(text_, value);
    } else {
      text_ += std::to_string(value);
    }
    return true;
  }

  bool add_boolean() {
    std::uint8_t value = 0;
    if (!read(value) || value > 1) return false;
    text_ += value == 1 ? "true" : "false";
    return true;
  }

  bool add_string() {
    std::uint32_t size = 0;
    if (!read(size) || data_.size() - at_ < size) return false;
    std::string_view string(reinterpret_cast<const char*>(data_.data() + at_), size);
    at_ += size;
    if (string.ends_with('\0')) string.remove_suffix(1);
    const nlohmann::json value = std::string(string);
    text_ += text::printable(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return true;
  }

  bool add(const Field& field, int depth) {
    if (field.repetition == Repetition::one) return add_one(field, depth);
    std::size_t count = field.count;
    if (field.repetition == Repetition::sequence) {
      std::uint32_t length = 0;
      if (!read(length)) return false;
      count = length;
    }
    if (count > data_.size() - at_) return false;  // each element has a byte at least
    text_ += '[';
    for (std::size_t i = 0; i < count; ++i) {
      if (i > 0) text_ += ',';
      if (!add_one(field, depth)) return false;
    }
    text_ += ']';
    return true;
  }

  bool add_one(const Field& field, int depth) {
    switch (field.kind) {
      case Kind::boolean:
        return add_boolean();
      case Kind::int8:
        return add_number<std::int8_t>();
      case Kind::uint8:
        return add_number<std::uint8_t>();
      case Kind::int16:
        return add_number<std::int16_t>();
      case Kind::uint16:
        return add_number<std::uint16_t>();
      case Kind::int32:
        return add_number<std::int32_t>();
      case Kind::uint32:
        return add_number<std::uint32_t>();
      case Kind::int64:
        return add_number<std::int64_t>();
      case Kind::uint64:
        return add_number<std::uint64_t>();
      case Kind::float32:
        return add_number<float>();
      case Kind::float64:
        return add_number<double>();
      case Kind::string:
        return add_string();
      case Kind::part:
        return add(types_[field.part], depth + 1);
    }
    return false;
  }

  std::span<const std::byte> data_;  ///< without the encapsulation header, to which fields are aligned
  bool is_foreign_;                  ///< in the other byte order
  const std::vector<Type>& types_;
  std::size_t at_ = 0;
  std::string text_;
};

}  // namespace

std::optional<MessageDefinition> MessageDefinition::parse(std::string_view type, std::string_view text) {
  const std::string first = short_name(type);
  const auto named = parse_types(first, text);
  if (!named) return std::nullopt;
  MessageDefinition definition;
  std::map<std::string, std::size_t, std::less<>> indexes{{first, 0}};
  std::vector<std::string> order{first};
  for (std::size_t i = 0; i < order.size(); ++i) {
    Type resolved;
    for (const NamedField& each : named->find(order[i])->second) {
      Field field = each.field;
      const auto* const primitive =
          std::ranges::find(primitives, each.type, &decltype(primitives)::value_type::first);
      field.kind = primitive == primitives.end() ? Kind::part : primitive->second;
      if (field.kind == Kind::part) {
        const auto found = find_type(*named, each.type, package_of(order[i]));
        if (found == named->end()) return std::nullopt;
        const auto [index, is_new] = indexes.try_emplace(found->first, order.size());
        if (is_new) order.push_back(found->first);
        field.part = index->second;
      }
      resolved.push_back(std::move(field));
    }
    definition.types_.push_back(std::move(resolved));
  }
  return definition;
}

std::string MessageDefinition::json_of(std::span<const std::byte> cdr) const {
  constexpr std::size_t header_bytes = 4;
  if (cdr.size() < header_bytes || cdr[0] != std::byte{} || cdr[1] > std::byte{1}) return {};
  const bool is_little = cdr[1] == std::byte{1};
  const bool is_foreign = is_little != (std::endian::native == std::endian::little);
  Conversion conversion(cdr.subspan(header_bytes), is_foreign, types_);
  return conversion.add(types_.front()) ? conversion.finish() : std::string();
}

}  // namespace sonopose::ros2::bag
