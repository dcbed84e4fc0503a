#include "settings/table_builder.hpp"
#include <sonopose/settings/settings_table.hpp>
#include <sonopose/text/nearest.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

namespace sonopose::settings {
namespace {

using detail::Builder;
using detail::Field;

// A field is addressed by its offset, and a Settings object copied as a whole.
static_assert(std::is_trivially_copyable_v<Settings>);

/// First the shared settings, then those of each engine.
const Builder& table() {
  static const Builder rows = [] {
    static const Settings defaults;
    Builder builder(defaults);
    for (const ReadBy engines : {ReadBy::all, ReadBy::kalman, ReadBy::documented}) {
      builder.collect(engines);
      detail::add_all(builder, defaults);
    }
    return builder;
  }();
  return rows;
}

/// First part of the keys that only these engines read.
std::string prefix_of(ReadBy engines) {
  switch (engines) {
    case ReadBy::documented:
      return "documented";
    case ReadBy::kalman:
      return "kalman";
    case ReadBy::all:
      break;
  }
  return {};
}

/// Key without the name of the engine.
std::string_view without_engine(const SettingInfo& row) {
  const std::string prefix = prefix_of(row.read_by);
  return std::string_view(row.key).substr(prefix.empty() ? 0 : prefix.size() + 1);
}

/// Joins two parts to "a.b"; an empty part is left out.
std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + "." + b;
}

const Field& field_of(const SettingInfo& info) {
  return table().fields[static_cast<std::size_t>(&info - table().infos.data())];
}

[[noreturn]] void refuse(const SettingInfo& info, const SettingValue& value, const std::string& why) {
  throw SettingError(info.key + " = " + to_text(value) + ": " + why + "; allowed: " + info.allowed());
}

/// Index of the chosen name. Throws SettingError for an unknown one.
std::size_t choice_of(const SettingInfo& info, const SettingValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) refuse(info, value, "not a name");
  const auto found = std::find(info.choices.begin(), info.choices.end(), *text);
  if (found == info.choices.end()) refuse(info, value, "not one of the choices");
  return static_cast<std::size_t>(found - info.choices.begin());
}

/// Value in the type of the setting. Throws SettingError unless it is in the range.
template <class Value>
Value checked(const SettingInfo& info, const SettingValue& value) {
  Value wanted{};
  const auto* whole = std::get_if<int>(&value);
  if (const auto* same = std::get_if<Value>(&value)) {
    wanted = *same;
  } else if (std::is_same_v<Value, double> && whole != nullptr) {
    wanted = static_cast<Value>(*whole);
  } else {
    refuse(info, value, "of the wrong type");
  }
  // A NaN compares false with everything, so it is out of range.
  const bool in_range = wanted >= std::get<Value>(info.minimum) && wanted <= std::get<Value>(info.maximum);
  if (!in_range) refuse(info, value, "out of range");
  return wanted;
}

}  // namespace

void detail::Builder::add(int item, std::string_view name, const void* field, SettingValue initial,
                          Range<SettingValue> range, std::string_view unit, std::string_view sentence) {
  if (read_by_ != collected_) return;
  const std::string group = joined(prefix_of(read_by_), group_);
  infos.push_back({item,
                   group + "." + std::string(name),
                   group,
                   std::string(name),
                   std::move(initial),
                   std::move(range.minimum),
                   std::move(range.maximum),
                   {},
                   std::string(unit),
                   std::string(sentence),
                   read_by_});
  const auto* const begin = reinterpret_cast<const std::byte*>(defaults_);
  const auto offset = static_cast<std::size_t>(static_cast<const std::byte*>(field) - begin);
  fields.push_back({.offset = offset});
}

std::string SettingInfo::allowed() const {
  if (std::holds_alternative<bool>(initial)) return "true or false";
  if (!choices.empty()) {
    std::string words(choices.front());
    for (std::size_t i = 1; i < choices.size(); ++i) {
      words += (i + 1 == choices.size() ? " or " : ", ") + std::string(choices[i]);
    }
    return words;
  }
  return to_text(minimum) + " … " + to_text(maximum) + (unit.empty() ? "" : " " + unit);
}

const std::vector<SettingInfo>& setting_table() {
  return table().infos;
}

const SettingInfo& setting_info(std::string_view key) {
  const auto& table = setting_table();
  const auto same =
      std::find_if(table.begin(), table.end(), [key](const auto& row) { return row.key == key; });
  if (same != table.end()) return *same;
  // Before version 0.2 the keys did not say which engine reads them.
  const std::string_view old_key = key == "fusion.imu_weight" ? "imu_weight" : key;
  for (const SettingInfo& row : table) {
    if (without_engine(row) == old_key) {
      throw RenamedSetting("'" + std::string(key) + "' is now called '" + row.key + "'");
    }
  }
  std::vector<std::string> keys;
  std::vector<std::string> names;
  for (const SettingInfo& row : table) {
    keys.push_back(row.key);
    names.emplace_back(without_engine(row));
  }
  const std::string unknown = "there is no setting '" + std::string(key) + "'";
  if (const auto meant = text::nearest(key, keys))
    throw SettingError(unknown + "; did you mean '" + *meant + "'?");
  const auto meant = text::nearest(key, names);
  if (!meant) throw SettingError(unknown + " (docs/settings.md lists all)");
  const auto row = std::find(names.begin(), names.end(), *meant) - names.begin();
  throw SettingError(unknown + "; did you mean '" + keys[static_cast<std::size_t>(row)] + "'?");
}

SettingValue get(const Settings& settings, std::string_view key) {
  const SettingInfo& info = setting_info(key);
  const Field& field = field_of(info);
  const void* const place = reinterpret_cast<const std::byte*>(&settings) + field.offset;
  if (field.chosen != nullptr) return std::string(info.choices[field.chosen(place)]);
  if (std::holds_alternative<bool>(info.initial)) return *static_cast<const bool*>(place);
  if (std::holds_alternative<int>(info.initial)) return *static_cast<const int*>(place);
  return *static_cast<const double*>(place);
}

void set(Settings& settings, std::string_view key, const SettingValue& value) {
  const SettingInfo& info = setting_info(key);
  const Field& field = field_of(info);
  void* const place = reinterpret_cast<std::byte*>(&settings) + field.offset;
  if (field.choose != nullptr) {
    field.choose(place, choice_of(info, value));
  } else if (std::holds_alternative<bool>(info.initial)) {
    *static_cast<bool*>(place) = checked<bool>(info, value);
  } else if (std::holds_alternative<int>(info.initial)) {
    *static_cast<int*>(place) = checked<int>(info, value);
  } else {
    *static_cast<double*>(place) = checked<double>(info, value);
  }
}

SettingValue parse_value(std::string_view key, std::string_view text) {
  const SettingInfo& info = setting_info(key);
  if (std::holds_alternative<std::string>(info.initial)) return std::string(text);
  if (std::holds_alternative<bool>(info.initial)) {
    if (text == "true") return true;
    if (text == "false") return false;
    refuse(info, std::string(text), "of the wrong type");
  }
  const auto number = [&]<class Number>(Number value) -> SettingValue {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      refuse(info, std::string(text), "of the wrong type");
    }
    return value;
  };
  return std::holds_alternative<int>(info.initial) ? number(int{}) : number(double{});
}

std::string to_text(const SettingValue& value) {
  struct Visitor {
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(int number) const { return std::to_string(number); }
    std::string operator()(double number) const {
      std::array<char, 32> text{};
      const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
      return {text.data(), error == std::errc{} ? end : text.data()};
    }
    std::string operator()(const std::string& text) const { return text; }
  };
  return std::visit(Visitor{}, value);
}

}  // namespace sonopose::settings
