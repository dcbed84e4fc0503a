#pragma once
/// \file
/// Reads a JSON object strictly: each field once, of the correct type, and no others. Private to this module.

#include "evaluation/state/state_file.hpp"
#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/samples/samples.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sonopose::evaluation {

/// Reads the fields of one object. Every member throws StateFileError with file and field.
class StateReader {
public:
  /// `place` is the file, and the path of fields to this object.
  StateReader(nlohmann::json object, std::string place);
  static StateReader parsed(std::string_view text, const std::string& name);

  std::string text(const char* name);
  std::uint64_t count(const char* name);
  std::uint32_t count32(const char* name);
  StateReader object(const char* name);

  void read(const char* name, double& value);
  void read(const char* name, bool& value);
  void read(const char* name, int& value);  ///< reads a count or index: not negative
  void read(const char* name, TimeNs& value);
  void read(const char* name, Vector3d& value);
  void read(const char* name, Quaterniond& q);  ///< reads a unit quaternion
  template <int size>
  void read(const char* name, Eigen::Matrix<double, size, size>& value) {
    read_rows(name, size, value.data());
  }
  void read(const char* name, attitude::AnyFilter& filter);

  /// Reads an enumeration by its name.
  template <class Choice>
  requires std::is_enum_v<Choice>
  void read(const char* name, Choice& value) {
    value = static_cast<Choice>(choice(name, choices_of(Choice{})));
  }

  /// Reads a fixed number of structs.
  template <class Record, std::size_t count>
  void read(const char* name, std::array<Record, count>& records) {
    const nlohmann::json elements = array(name);
    if (elements.size() != count) {
      fail(name, "has " + std::to_string(elements.size()) + " elements instead of " + std::to_string(count));
    }
    for (std::size_t i = 0; i < count; ++i) read_element(name, elements[i], records[i]);
  }

  /// Reads structs in the order of time, up to the capacity of `records`.
  template <class Sequence>
  requires requires(Sequence& records, const typename Sequence::value_type& record) {
    records.accepts(record);
    records.push(record);
  }
  void read(const char* name, Sequence& records) {
    const nlohmann::json elements = array(name);
    if (elements.size() > Sequence::capacity) {
      fail(name, "has " + std::to_string(elements.size()) + " elements, more than " +
                     std::to_string(Sequence::capacity));
    }
    records = {};
    for (const nlohmann::json& element : elements) {
      typename Sequence::value_type record;
      read_element(name, element, record);
      if (!records.accepts(record)) fail(name, "has times that go backward");
      records.push(record);
    }
  }

  template <class Record>
  requires requires(Record& record) {
    for_each_field(record, [](const char*, auto&) {});
  }
  void read(const char* name, Record& record) { read_element(name, take(name), record); }

  /// Reads any number of structs.
  template <class Record>
  void read(const char* name, std::vector<Record>& records) {
    records.clear();
    for (const nlohmann::json& element : array(name)) read_element(name, element, records.emplace_back());
  }

  /// Fails if a field is left, since it is unknown. Call it after the last field.
  void finish() const;

  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

private:
  nlohmann::json take(const char* name);
  nlohmann::json array(const char* name);
  void read_rows(const char* name, int size, double* by_columns);
  template <std::size_t Count>
  std::array<double, Count> take_numbers(const char* name, const char* wanted);
  /// Returns the index of the word in `choices`.
  std::size_t choice(const char* name, std::span<const std::string_view> choices);

  template <class Record>
  void read_element(const char* name, const nlohmann::json& element, Record& record) {
    StateReader fields(element, place_ + ": " + name);
    for_each_field(record, [&fields](const char* field, auto& value) { fields.read(field, value); });
    fields.finish();
  }

  nlohmann::json object_;
  std::string place_;
};

}  // namespace sonopose::evaluation
