#include "settings/setting_visit.hpp"
#include <sonopose/settings/settings.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace sonopose::settings {
namespace {

using detail::for_each_setting;

template <class Value>
SettingValue boxed(Value value) {
  if constexpr (std::is_enum_v<Value>) {
    return std::string(choices_of(value)[static_cast<std::size_t>(value)]);
  } else {
    return value;
  }
}

template <class Group, class Value>
SettingInfo info_of(const Declaration<Group, Value>& row) {
  SettingInfo info{row.item,
                   std::string(Group::group) + "." + std::string(row.name),
                   std::string(Group::group),
                   std::string(row.name),
                   boxed(row.initial),
                   boxed(row.minimum),
                   boxed(row.maximum),
                   {},
                   std::string(row.unit),
                   std::string(row.sentence)};
  if constexpr (std::is_enum_v<Value>) {
    for (const auto name : choices_of(Value{})) info.choices.push_back(name);
  }
  return info;
}

[[noreturn]] void refuse(const SettingInfo& info, const SettingValue& value, const std::string& why) {
  throw SettingError(info.key + " = " + to_text(value) + ": " + why + "; allowed: " + info.allowed());
}

/// The value in the kind of the field, or an error.
template <class Value>
Value unboxed(const SettingInfo& info, const SettingValue& value) {
  if constexpr (std::is_enum_v<Value>) {
    const auto* text = std::get_if<std::string>(&value);
    if (text == nullptr) refuse(info, value, "not a name");
    const auto found = std::find(info.choices.begin(), info.choices.end(), *text);
    if (found == info.choices.end()) refuse(info, value, "not one of the choices");
    return static_cast<Value>(found - info.choices.begin());
  } else {
    if constexpr (std::is_same_v<Value, double>) {
      if (const auto* whole = std::get_if<int>(&value)) return *whole;
    }
    const auto* same = std::get_if<Value>(&value);
    if (same == nullptr) refuse(info, value, "of the wrong kind");
    return *same;
  }
}

/// Levenshtein's distance, to name the key that was meant.
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

Settings resolved(Settings settings) {
  apply_preset(settings.preset, settings.drift, settings.velocity);
  return settings;
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
  static const std::vector<SettingInfo> table = [] {
    std::vector<SettingInfo> rows;
    Settings settings;
    for_each_setting(settings,
                     [&rows](const auto& row, const auto& /*value*/) { rows.push_back(info_of(row)); });
    return rows;
  }();
  return table;
}

const SettingInfo& setting_info(std::string_view key) {
  const auto& table = setting_table();
  const auto same =
      std::find_if(table.begin(), table.end(), [key](const auto& row) { return row.key == key; });
  if (same != table.end()) return *same;
  const auto nearest = std::min_element(table.begin(), table.end(), [key](const auto& a, const auto& b) {
    return edits_between(a.key, key) < edits_between(b.key, key);
  });
  throw SettingError("there is no setting '" + std::string(key) + "'; the nearest is '" + nearest->key + "'");
}

SettingValue get(const Settings& settings, std::string_view key) {
  const SettingInfo& info = setting_info(key);
  SettingValue found;
  for_each_setting(settings, [&](const auto& row, const auto& value) {
    if (info.name == row.name && info.group == detail::group_of(row)) found = boxed(value);
  });
  return found;
}

void set(Settings& settings, std::string_view key, const SettingValue& value) {
  const SettingInfo& info = setting_info(key);
  for_each_setting(settings, [&](const auto& row, auto& field) {
    if (info.name != row.name || info.group != detail::group_of(row)) return;
    const auto wanted = unboxed<std::remove_cvref_t<decltype(field)>>(info, value);
    // Written so that a NaN, which compares with nothing, is out of range.
    if (!(wanted >= row.minimum && wanted <= row.maximum)) refuse(info, value, "out of range");
    field = wanted;
  });
}

SettingValue parse_value(std::string_view key, std::string_view text) {
  const SettingInfo& info = setting_info(key);
  if (std::holds_alternative<std::string>(info.initial)) return std::string(text);
  if (std::holds_alternative<bool>(info.initial)) {
    if (text == "true") return true;
    if (text == "false") return false;
    refuse(info, std::string(text), "of the wrong kind");
  }
  const auto number = [&]<class Number>(Number value) -> SettingValue {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      refuse(info, std::string(text), "of the wrong kind");
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
