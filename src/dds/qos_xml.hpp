#pragma once
// Reading of OMG DDS-XML elements: strict, with errors that name file, line and element.

#include <sonopose/dds/qos.hpp>

#include <pugixml.hpp>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace sonopose::dds::qos_xml {

/// The text that a document was made from, for the line numbers.
class Source {
public:
  Source(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {}

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }

  /// Throws `QosFileError`: `file:line: reason`, for a place in the text.
  [[noreturn]] void fail_at(std::ptrdiff_t offset, const std::string& reason) const;
  /// Throws `QosFileError`: `file:line: <element>: reason`.
  [[noreturn]] void fail(const pugi::xml_node& element, const std::string& reason) const;

  /// Fails for an attribute that is not among the `allowed`, and for one that stands twice.
  void check_attributes(const pugi::xml_node& element, std::initializer_list<std::string_view> allowed) const;

private:
  std::string name_;
  std::string text_;
};

/// Reads the policies of `<datawriter_qos>`, `<datareader_qos>`, `<topic_qos>` or `<domainparticipant_qos>`
/// into `qos`, over what it has.
void read_policies(const Source& source, const pugi::xml_node& element, Qos& qos);

}  // namespace sonopose::dds::qos_xml
