#pragma once
/// \file
/// Pairs a native field with the IDL members that carry it. A conversion walks the pairs of a type
/// (field_lists.hpp).

#include <sonopose/idl/sonopose.h>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

// The IDL's arrays are C arrays. NOLINTBEGIN(modernize-avoid-c-arrays)

namespace sonopose::dds::topics::fields {

// Conversions of single values, native ↔ IDL.

template <class T>
requires std::is_arithmetic_v<T>
void copy(const T& from, T& to) {
  to = from;
}

inline void copy(const Vector3d& from, sonopose_Vector3& to) {
  to = {from.x(), from.y(), from.z()};
}
inline void copy(const sonopose_Vector3& from, Vector3d& to) {
  to = {from.x, from.y, from.z};
}

inline void copy(const Quaterniond& from, sonopose_Quaternion& to) {
  to = {from.w(), from.x(), from.y(), from.z()};
}
inline void copy(const sonopose_Quaternion& from, Quaterniond& to) {
  to = Quaterniond(from.w, from.x, from.y, from.z);
}

template <int N, std::size_t Size>
void copy(const Covariance<N>& from, double (&to)[Size]) {
  static_assert(Size == Covariance<N>::element_count);
  std::copy(from.elements().begin(), from.elements().end(), to);
}
template <int N, std::size_t Size>
void copy(const double (&from)[Size], Covariance<N>& to) {
  static_assert(Size == Covariance<N>::element_count);
  std::array<double, Size> elements;
  std::copy(from, from + Size, elements.begin());
  to = Covariance<N>(elements);
}

inline void copy(const std::optional<ScalarEstimate>& from, sonopose_ScalarEstimate& to) {
  const ScalarEstimate estimate = from.value_or(ScalarEstimate{});
  to = {estimate.value, estimate.std, from.has_value()};
}
inline void copy(const sonopose_ScalarEstimate& from, std::optional<ScalarEstimate>& to) {
  to = from.valid ? std::optional(ScalarEstimate{from.value, from.std}) : std::nullopt;
}

inline void copy(const std::optional<VectorEstimate>& from, sonopose_VectorEstimate& to) {
  const VectorEstimate estimate = from.value_or(VectorEstimate{});
  copy(estimate.value, to.value);
  copy(estimate.std, to.std);
  to.valid = from.has_value();
}
inline void copy(const sonopose_VectorEstimate& from, std::optional<VectorEstimate>& to) {
  to.reset();
  if (!from.valid) return;
  to.emplace();
  copy(from.value, to->value);
  copy(from.std, to->std);
}

/// Copies a bounded string, whose array has room for the terminator.
template <std::size_t Size>
void copy(const std::string& from, char (&to)[Size]) {
  if (from.size() >= Size) {
    throw std::length_error("\"" + from.substr(0, 32) + "...\" has " + std::to_string(from.size()) +
                            " bytes, more than the " + std::to_string(Size - 1) + " of the DDS type");
  }
  std::memcpy(to, from.c_str(), from.size() + 1);
}
template <std::size_t Size>
void copy(const char (&from)[Size], std::string& to) {
  to.assign(from, strnlen(from, Size));
}

// The kinds of pairs. `idl_members` is the number of IDL members that a pair covers; a test counts them.

/// A value without conversion.
template <class Native, class Idl, class NativeField, class IdlField>
struct Plain {
  NativeField Native::*native;
  IdlField Idl::*idl;
  static constexpr int idl_members = 1;

  void write(const Native& from, Idl& to) const { copy(from.*native, to.*idl); }
  void read(const Idl& from, Native& to) const { copy(from.*idl, to.*native); }
};

template <class Native, class Idl, class NativeField, class IdlField>
constexpr Plain<Native, Idl, NativeField, IdlField> field(NativeField Native::*native, IdlField Idl::*idl) {
  return {native, idl};
}

/// An optional as a value and a validity flag. An invalid value is zero.
template <class Native, class Idl, class Value, class IdlField>
struct Flagged {
  std::optional<Value> Native::*native;
  IdlField Idl::*idl;
  bool Idl::*valid;
  static constexpr int idl_members = 2;

  void write(const Native& from, Idl& to) const {
    to.*valid = (from.*native).has_value();
    if (from.*native) copy(*(from.*native), to.*idl);
  }
  void read(const Idl& from, Native& to) const {
    (to.*native).reset();
    if (from.*valid) copy(from.*idl, (to.*native).emplace());
  }
};

template <class Native, class Idl, class Value, class IdlField>
constexpr Flagged<Native, Idl, Value, IdlField> field(std::optional<Value> Native::*native,
                                                      IdlField Idl::*idl, bool Idl::*valid) {
  return {native, idl, valid};
}

/// An optional non-negative number. A negative number or NaN on the wire reads as empty.
template <class Native, class Idl, class IdlNumber>
struct NegativeMeansEmpty {
  std::optional<double> Native::*native;
  IdlNumber Idl::*idl;
  static constexpr int idl_members = 1;

  void write(const Native& from, Idl& to) const {
    to.*idl = from.*native ? static_cast<IdlNumber>(*(from.*native)) : IdlNumber{-1};
  }
  void read(const Idl& from, Native& to) const {
    to.*native = from.*idl >= IdlNumber{0} ? std::optional<double>(from.*idl) : std::nullopt;
  }
};

template <class Native, class Idl, class IdlNumber>
constexpr NegativeMeansEmpty<Native, Idl, IdlNumber> non_negative(std::optional<double> Native::*native,
                                                                  IdlNumber Idl::*idl) {
  return {native, idl};
}

/// An enumeration as a number. A number above `last`, from another version, reads as the first enumerator.
template <class Native, class Idl, class Enum>
struct Enumeration {
  Enum Native::*native;
  std::uint32_t Idl::*idl;
  Enum last;
  static constexpr int idl_members = 1;

  void write(const Native& from, Idl& to) const { to.*idl = static_cast<std::uint32_t>(from.*native); }
  void read(const Idl& from, Native& to) const {
    const std::uint32_t number = from.*idl;
    to.*native = number <= static_cast<std::uint32_t>(last) ? static_cast<Enum>(number) : Enum{};
  }
};

template <class Native, class Idl, class Enum>
constexpr Enumeration<Native, Idl, Enum> enumeration(Enum Native::*native, std::uint32_t Idl::*idl,
                                                     Enum last) {
  return {native, idl, last};
}

/// A text for people. If it is too long, it is cut at the start of a UTF-8 character and ends in "...".
template <class Native, class Idl, std::size_t Size>
struct CutText {
  std::string Native::*native;
  char (Idl::*idl)[Size];
  static constexpr int idl_members = 1;

  void write(const Native& from, Idl& to) const {
    const std::string& text = from.*native;
    if (text.size() < Size) return copy(text, to.*idl);
    constexpr std::string_view mark = "...";
    std::size_t length = Size - 1 - mark.size();
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) --length;
    copy(text.substr(0, length).append(mark), to.*idl);
  }
  void read(const Idl& from, Native& to) const { copy(from.*idl, to.*native); }
};

template <class Native, class Idl, std::size_t Size>
constexpr CutText<Native, Idl, Size> cut_text(std::string Native::*native, char (Idl::*idl)[Size]) {
  return {native, idl};
}

// Conversions of all pairs of a list.

template <class Idl, class Native, class... Fields>
void write(const std::tuple<Fields...>& list, const Native& from, Idl& to) {
  std::apply([&](const auto&... each) { (each.write(from, to), ...); }, list);
}

template <class Idl, class Native, class... Fields>
void read(const std::tuple<Fields...>& list, const Idl& from, Native& to) {
  std::apply([&](const auto&... each) { (each.read(from, to), ...); }, list);
}

/// The number of IDL members that a list covers.
template <class... Fields>
constexpr int idl_members(const std::tuple<Fields...>& /*list*/) {
  return (0 + ... + Fields::idl_members);
}

}  // namespace sonopose::dds::topics::fields

// NOLINTEND(modernize-avoid-c-arrays)
