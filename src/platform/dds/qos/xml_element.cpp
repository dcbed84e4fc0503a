#include "dds/qos/xml_element.hpp"

#include <sonopose/dds/qos/provider.hpp>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

namespace sonopose::dds::qos::xml {

void Source::fail_at(std::ptrdiff_t offset, const std::string& reason) const {
  const auto end = text_.begin() + std::min<std::ptrdiff_t>(std::max<std::ptrdiff_t>(offset, 0),
                                                            static_cast<std::ptrdiff_t>(text_.size()));
  const auto line = 1 + std::count(text_.begin(), end, '\n');
  throw FileError(name_ + ":" + std::to_string(line) + ": " + reason);
}

void Source::fail(const pugi::xml_node& element, const std::string& reason) const {
  fail_at(element.offset_debug(), std::string("<") + element.name() + ">: " + reason);
}

void Source::check_attributes(const pugi::xml_node& element,
                              std::initializer_list<std::string_view> allowed) const {
  std::set<std::string_view> seen;
  for (const pugi::xml_attribute attribute : element.attributes()) {
    const std::string_view name = attribute.name();
    const std::string quoted = "attribute '" + std::string(name) + "'";
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end()) fail(element, "unknown " + quoted);
    if (!seen.insert(name).second) fail(element, quoted + " occurs twice");
  }
}

Parent::Parent(const Source& source, const pugi::xml_node& element,
               std::initializer_list<std::string_view> children)
    : source_(source), element_(element) {
  source.check_attributes(element, {});
  std::set<std::string_view> seen;
  for (const pugi::xml_node child : element.children()) {
    const std::string_view name = child.name();
    if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
      source.fail(element, "unexpected text '" + std::string(child.value()) + "'");
    }
    if (std::find(children.begin(), children.end(), name) == children.end()) {
      source.fail(child, std::string("unknown element in <") + element.name() + ">");
    }
    if (!seen.insert(name).second) source.fail(child, "occurs twice");
  }
}

pugi::xml_node Parent::need(const char* name) const {
  const pugi::xml_node child = element_.child(name);
  if (child.empty()) source_.fail(element_, std::string("<") + name + "> is missing");
  return child;
}

std::string text_of(const Source& source, const pugi::xml_node& element) {
  source.check_attributes(element, {});
  for (const pugi::xml_node child : element.children()) {
    if (child.type() == pugi::node_element) source.fail(child, "unknown element where a value is expected");
  }
  const std::string text = element.child_value();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) source.fail(element, "a value is missing");
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::int64_t number(const Source& source, const pugi::xml_node& element, std::int64_t lowest,
                    std::int64_t highest, const Words& words) {
  const std::string text = text_of(source, element);
  if (const auto word = words.find(text); word != words.end()) return word->second;
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size() || value < lowest || value > highest) {
    source.fail(element, "'" + text + "' is no whole number from " + std::to_string(lowest) + " to " +
                             std::to_string(highest));
  }
  return value;
}

std::int32_t number32(const Source& source, const pugi::xml_node& element, std::int64_t lowest,
                      const Words& words) {
  return static_cast<std::int32_t>(number(source, element, lowest, int32_max, words));
}

core::Duration duration(const Source& source, const pugi::xml_node& element) {
  constexpr std::int64_t forever = -1;
  const Parent parent(source, element, {"sec", "nanosec"});
  if (!parent.has("sec") && !parent.has("nanosec")) {
    source.fail(element, "a duration needs <sec>, <nanosec> or both");
  }
  std::optional<std::int64_t> seconds;
  std::optional<std::int64_t> nanoseconds;
  if (parent.has("sec")) {
    seconds = number(source, parent.need("sec"), 0, int32_max,
                     {{"DURATION_INFINITE_SEC", forever}, {"DURATION_INFINITY", forever}});
  }
  if (parent.has("nanosec")) {
    nanoseconds = number(source, parent.need("nanosec"), 0, 999'999'999,
                         {{"DURATION_INFINITE_NSEC", forever}, {"DURATION_INFINITY", forever}});
  }
  const bool infinite_sec = seconds == forever;
  const bool infinite_nsec = nanoseconds == forever;
  if ((infinite_sec && nanoseconds && !infinite_nsec) || (infinite_nsec && seconds && !infinite_sec)) {
    source.fail(element, "only one of <sec> and <nanosec> is infinite");
  }
  if (infinite_sec || infinite_nsec) return core::Duration::infinite();
  return core::Duration(seconds.value_or(0), static_cast<std::uint32_t>(nanoseconds.value_or(0)));
}

core::Duration positive_duration(const Source& source, const pugi::xml_node& element) {
  const core::Duration value = duration(source, element);
  if (value == core::Duration::zero()) source.fail(element, "must be more than zero");
  return value;
}

std::vector<std::uint8_t> base64(const Source& source, const pugi::xml_node& element) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text = text_of(source, element);
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == ' '; }),
             text.end());
  const bool whole = text.size() % 4 == 0;
  for (int i = 0; i < 2 && !text.empty() && text.back() == '='; ++i) text.pop_back();
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t value = alphabet.find(c);
    if (!whole || value == std::string_view::npos) source.fail(element, "is not base64");
    bits = (bits << 6U) | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(count)));
    }
  }
  return bytes;
}

}  // namespace sonopose::dds::qos::xml
