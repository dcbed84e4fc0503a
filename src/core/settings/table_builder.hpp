#pragma once
// Collects the rows of the table of settings.

#include <sonopose/settings/settings.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::settings::detail {

/// Place of a setting in a Settings object, in bytes from its begin.
struct Field {
  std::size_t offset = 0;
  // Set for a choice, whose type only these functions know:
  std::size_t (*chosen)(const void* field) = nullptr;
  void (*choose)(void* field, std::size_t index) = nullptr;
};

/// Allowed values, both endpoints included.
template <class Value>
struct Range {
  Value minimum;
  Value maximum;
};

/// Builds rows, each with a field of the object of defaults given to the constructor.
class Builder {
public:
  explicit Builder(const Settings& defaults) : defaults_(&defaults) {}

  /// Starts a group for the following rows.
  void group(std::string_view name) { group_ = name; }

  /// Sets the engines that read the following rows, whatever their group.
  void read_by(ReadBy engines) { read_by_ = engines; }

  /// Adds only those of the following rows that these engines read.
  void collect(ReadBy engines) {
    collected_ = engines;
    read_by_ = ReadBy::all;
  }

  void real(int item, std::string_view name, const double& field, Range<double> range, std::string_view unit,
            std::string_view sentence) {
    add(item, name, &field, field, {range.minimum, range.maximum}, unit, sentence);
  }
  void count(int item, std::string_view name, const int& field, Range<int> range, std::string_view unit,
             std::string_view sentence) {
    add(item, name, &field, field, {range.minimum, range.maximum}, unit, sentence);
  }
  void flag(int item, std::string_view name, const bool& field, std::string_view sentence) {
    add(item, name, &field, field, {false, true}, "", sentence);
  }
  template <class Enum>
  void choice(int item, std::string_view name, const Enum& field, std::string_view sentence) {
    const auto names = choices_of(Enum{});
    add(item, name, &field, std::string(names[static_cast<std::size_t>(field)]),
        {std::string(names.front()), std::string(names.back())}, "", sentence);
    if (read_by_ != collected_) return;
    infos.back().choices.assign(names.begin(), names.end());
    fields.back().chosen = [](const void* place) {
      return static_cast<std::size_t>(*static_cast<const Enum*>(place));
    };
    fields.back().choose = [](void* place, std::size_t index) {
      *static_cast<Enum*>(place) = static_cast<Enum>(index);
    };
  }

  std::vector<SettingInfo> infos;
  std::vector<Field> fields;  ///< fields in the order of the rows

private:
  void add(int item, std::string_view name, const void* field, SettingValue initial,
           Range<SettingValue> range, std::string_view unit, std::string_view sentence);

  const Settings* defaults_;
  std::string group_;
  ReadBy read_by_ = ReadBy::all;
  ReadBy collected_ = ReadBy::all;
};

/// Adds every row, in the order of the groups in Settings.
void add_all(Builder& table, const Settings& defaults);

}  // namespace sonopose::settings::detail
