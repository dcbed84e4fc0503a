#pragma once
// Reads elements of OMG DDS-XML below a policy. Strict: errors name file, line and element.

#include <sonopose/dds/psm/qos.hpp>

#include <pugixml.hpp>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::dds::qos::xml {

/// The source text of a document, for line numbers.
class Source {
public:
  Source(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {}

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }

  /// Throws `FileError` with `file:line: reason` for a position in the text.
  [[noreturn]] void fail_at(std::ptrdiff_t offset, const std::string& reason) const;
  /// Throws `FileError` with `file:line: <element>: reason`.
  [[noreturn]] void fail(const pugi::xml_node& element, const std::string& reason) const;

  /// Fails for an attribute that is not `allowed` or occurs twice.
  void check_attributes(const pugi::xml_node& element, std::initializer_list<std::string_view> allowed) const;

private:
  std::string name_;
  std::string text_;
};

/// An element with known children, each at most once, without text between them and without attributes.
class Parent {
public:
  Parent(const Source& source, const pugi::xml_node& element,
         std::initializer_list<std::string_view> children);

  bool has(const char* name) const { return !element_.child(name).empty(); }

  /// Returns the child; fails if it is missing.
  pugi::xml_node need(const char* name) const;

private:
  const Source& source_;
  pugi::xml_node element_;
};

/// Returns the text of an element that contains nothing else.
std::string text_of(const Source& source, const pugi::xml_node& element);

/// Words that are allowed instead of a number.
using Words = std::map<std::string, std::int64_t>;

/// Reads an integer from `lowest` to `highest`, or one of the `words`.
std::int64_t number(const Source& source, const pugi::xml_node& element, std::int64_t lowest,
                    std::int64_t highest, const Words& words = {});

inline constexpr std::int64_t int32_min = std::numeric_limits<std::int32_t>::min();
inline constexpr std::int64_t int32_max = std::numeric_limits<std::int32_t>::max();

/// Number in the range of 32-bit integers.
std::int32_t number32(const Source& source, const pugi::xml_node& element, std::int64_t lowest,
                      const Words& words = {});

/// Reads `<sec>` and `<nanosec>`. Infinite if all given parts are infinite.
core::Duration duration(const Source& source, const pugi::xml_node& element);
/// Duration above zero.
core::Duration positive_duration(const Source& source, const pugi::xml_node& element);

std::vector<std::uint8_t> base64(const Source& source, const pugi::xml_node& element);

/// Reads the `<kind>` of a policy: one of the names in `kinds`.
template <class Kind>
Kind kind_of(const Source& source, const Parent& parent, const std::map<std::string, Kind>& kinds) {
  const pugi::xml_node element = parent.need("kind");
  const std::string text = text_of(source, element);
  const auto found = kinds.find(text);
  if (found == kinds.end()) {
    std::string allowed;
    for (const auto& [name, kind] : kinds) allowed += (allowed.empty() ? "" : ", ") + name;
    source.fail(element, "'" + text + "' is not one of " + allowed);
  }
  return found->second;
}

}  // namespace sonopose::dds::qos::xml
