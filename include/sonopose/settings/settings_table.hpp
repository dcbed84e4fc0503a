#pragma once
/// \file
/// The table of all settings: access by key, range checks, and the text for help, configuration files and
/// docs.

#include <sonopose/settings/settings.hpp>

#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sonopose::settings {

/// Item of a setting that is not one of the document's 37.
inline constexpr int no_item = 0;

/// A value of any type of setting; a choice is the name of its value.
using SettingValue = std::variant<bool, int, double, std::string>;

/// Engines that read a setting.
enum class ReadBy { all, documented, kalman };

/// One row of the table.
struct SettingInfo {
  int item;           ///< number in the fusion document, or no_item
  std::string key;    ///< "group.name"
  std::string group;  ///< may contain dots
  std::string name;
  SettingValue initial;
  SettingValue minimum;  ///< meaningful for an int or a double
  SettingValue maximum;
  std::vector<std::string_view> choices;  ///< empty unless the setting is a choice
  std::string unit;
  std::string sentence;
  ReadBy read_by = ReadBy::all;

  /// Allowed values as text: "0 … 50 1/s", "true or false", "low, medium, high or user".
  [[nodiscard]] std::string allowed() const;
};

/// A setting that cannot be used. The message names the key, the value and the allowed values.
class SettingError : public std::invalid_argument {
public:
  using std::invalid_argument::invalid_argument;
};

/// A key of an earlier version. The message names its successor.
class RenamedSetting : public SettingError {
public:
  using SettingError::SettingError;
};

/// All settings: first the shared ones, then those of each engine, in the order of the groups in Settings.
const std::vector<SettingInfo>& setting_table();

/// Row of `key`. Throws SettingError, which names the nearest key, for an unknown one.
const SettingInfo& setting_info(std::string_view key);

/// Value of `key`. Throws SettingError for an unknown key.
SettingValue get(const Settings& settings, std::string_view key);

/// Sets `key`. An int is accepted for a double. Throws SettingError and changes nothing for an unknown key, a
/// value of the wrong type or one out of range.
void set(Settings& settings, std::string_view key, const SettingValue& value);

/// Parses the value of `key` as typed on a command line ("true", "12", "0.5", "medium"), without checking its
/// range. Throws SettingError for an unknown key and for text that is not of the key's type.
SettingValue parse_value(std::string_view key, std::string_view text);

/// Value as text from which parse_value() reads the same bits.
std::string to_text(const SettingValue& value);

}  // namespace sonopose::settings
