#pragma once
/// \file
/// How a setting is declared: once, in its stage's group, as a row that holds its item number in the fusion
/// document, name, field, default, range, unit and one sentence. From these rows come the range checks, the
/// programs' help, the commented configuration file and the page of the docs.

#include <string_view>

namespace sonopose::settings {

/// A setting that is not one of the document's 37.
inline constexpr int own_setting = 0;

/// One row: `Value` is bool, int, double or an enum for which `choices_of(Value)` names the values.
template <class Group, class Value>
struct Declaration {
  int item = own_setting;
  std::string_view name;
  Value Group::*field = nullptr;
  Value initial{};
  Value minimum{};
  Value maximum{};
  std::string_view unit;
  std::string_view sentence;
};

/// Allowed values, both ends included.
template <class Value>
struct Range {
  Value minimum;
  Value maximum;
};

template <class Group>
constexpr Declaration<Group, double> real(int item, std::string_view name, double Group::*field,
                                          double initial, Range<double> range, std::string_view unit,
                                          std::string_view sentence) {
  return {item, name, field, initial, range.minimum, range.maximum, unit, sentence};
}

template <class Group>
constexpr Declaration<Group, int> count(int item, std::string_view name, int Group::*field, int initial,
                                        Range<int> range, std::string_view unit, std::string_view sentence) {
  return {item, name, field, initial, range.minimum, range.maximum, unit, sentence};
}

template <class Group>
constexpr Declaration<Group, bool> flag(int item, std::string_view name, bool Group::*field, bool initial,
                                        std::string_view sentence) {
  return {item, name, field, initial, false, true, "", sentence};
}

template <class Group, class Enum>
constexpr Declaration<Group, Enum> choice(int item, std::string_view name, Enum Group::*field, Enum initial,
                                          std::string_view sentence) {
  constexpr auto names = choices_of(Enum{});
  return {item, name, field, initial, Enum{}, static_cast<Enum>(names.size() - 1), "", sentence};
}

/// Rows, to be given to a function as its arguments: `rows(a, b)(f)` is `f(a, b)`. Every file that includes a
/// settings group compiles its rows, and a std::tuple of as many would take most of its time.
template <class... Row>
constexpr auto rows(const Row&... row) {
  return [row...](const auto& function) { return function(row...); };
}

/// The rows of both, one after the other.
template <class First, class Second>
constexpr auto joined(const First& first, const Second& second) {
  return [first, second](const auto& function) {
    return first(
        [&](const auto&... a) { return second([&](const auto&... b) { return function(a..., b...); }); });
  };
}

/// Gives every setting of `group` its declared default.
template <class Group>
constexpr void set_defaults(Group& group) {
  Group::declarations()([&group](const auto&... row) { ((group.*(row.field) = row.initial), ...); });
}

}  // namespace sonopose::settings
