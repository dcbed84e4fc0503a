#pragma once
/// \file
/// IDL samples whose fields all have different values.

#include <sonopose/idl/field_visitors.hpp>

#include <cstdio>
#include <type_traits>

namespace sonopose::test {

/// Fills fields with ascending values; 64-bit integers exceed the range that a double represents exactly.
class FilledFields {
public:
  template <class Sample>
  void fill(Sample& sample) {
    // The visitor passes const references to the fields of a non-const object.
    idl::visit_fields(sample, [this](const char*, const auto& field) {
      this->put(const_cast<std::remove_cvref_t<decltype(field)>&>(field));
    });
  }

private:
  void put(bool& field) { field = (++last_ % 2) == 0; }
  template <class Value>
  void put(Value& field) {
    using Element = std::remove_extent_t<Value>;
    if constexpr (std::is_floating_point_v<Value>) {
      field = static_cast<Value>(++last_) / Value{3};
    } else if constexpr (std::is_integral_v<Value>) {
      field = static_cast<Value>(++last_ + (sizeof(Value) == 8 ? 1'700'000'000'000'000'000 : 0));
    } else if constexpr (std::is_same_v<Element, char>) {
      std::snprintf(field, sizeof field, "text \"%d\" \\ \xc3\xbc", ++last_);
    } else if constexpr (std::is_array_v<Value>) {
      for (Element& element : field) put(element);
    } else if constexpr (!requires { field._buffer; }) {
      fill(field);
    }
  }

  int last_ = 0;
};

}  // namespace sonopose::test
