#pragma once
/// \file
/// Writes samples of native topics as JSON, with the names of the IDL.

#include <sonopose/idl/field_visitors.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <string>
#include <type_traits>

namespace sonopose::json {

template <class Value>
void append_json(std::string& text, const Value& value);

template <class Value>
void append_array(std::string& text, const Value* values, std::size_t count) {
  text += '[';
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ',';
    append_json(text, values[i]);
  }
  text += ']';
}

/// Appends the shortest text that reads back to the same bits. It never looks like an integer, so that the
/// type of a field does not depend on its value. Infinity and NaN become null.
template <class Real>
void append_real(std::string& text, Real value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{}", value);
  if (text.find_first_of(".e", begin) == std::string::npos) text += ".0";
}

/// Appends a value of the IDL: a number, boolean, string, array or sequence, or a struct as an object with
/// its fields in the order of the IDL.
template <class Value>
void append_json(std::string& text, const Value& value) {
  using Element = std::remove_extent_t<Value>;
  if constexpr (std::is_same_v<Value, bool>) {
    text += value ? "true" : "false";
  } else if constexpr (std::is_floating_point_v<Value>) {
    append_real(text, value);
  } else if constexpr (std::is_integral_v<Value>) {
    fmt::format_to(std::back_inserter(text), "{}", value);
  } else if constexpr (std::is_array_v<Value> && std::is_same_v<Element, char>) {
    const nlohmann::json string(std::string(value, ::strnlen(value, std::extent_v<Value>)));
    text += text::printable(string.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else if constexpr (std::is_array_v<Value>) {
    append_array(text, value, std::extent_v<Value>);
  } else if constexpr (requires { value._buffer[value._length]; }) {
    append_array(text, value._buffer, value._length);
  } else {
    char separator = '{';
    idl::visit_fields(value, [&](const char* name, const auto& field) {
      text += separator;
      text += '"';
      text += name;
      text += "\":";
      append_json(text, field);
      separator = ',';
    });
    text += '}';
  }
}

/// Writes a sample as one object on one line, without a newline.
template <class Sample>
std::string json_of(const Sample& sample) {
  std::string text;
  append_json(text, sample);
  return text;
}

}  // namespace sonopose::json
