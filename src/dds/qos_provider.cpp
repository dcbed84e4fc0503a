#include "qos_xml.hpp"
#include <sonopose/dds/qos_provider.hpp>

#include <pugixml.hpp>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>

namespace sonopose::dds {
namespace {

using Profiles = std::map<std::string, QosProvider::Profile>;

/// The `name` attribute, which must be there and may not hold the separator.
std::string name_of(const qos_xml::Source& source, const pugi::xml_node& element) {
  std::string name = element.attribute("name").value();
  if (name.empty()) source.fail(element, "attribute 'name' is missing");
  if (name.find("::") != std::string::npos) source.fail(element, "'" + name + "' holds '::'");
  return name;
}

/// The children of `element`, all called `name`.
std::vector<pugi::xml_node> children_of(const qos_xml::Source& source, const pugi::xml_node& element,
                                        const std::string& name) {
  std::vector<pugi::xml_node> result;
  for (const pugi::xml_node child : element.children()) {
    if (child.type() != pugi::node_element) source.fail(element, "unexpected text");
    if (child.name() != name) {
      source.fail(child, std::string("unknown element in <") + element.name() + ">");
    }
    result.push_back(child);
  }
  return result;
}

QosProvider::Profile inherited(const qos_xml::Source& source, const pugi::xml_node& element,
                               const std::string& library, const Profiles& profiles) {
  const pugi::xml_attribute base = element.attribute("base_name");
  if (base.empty()) return {};
  std::string name = base.value();
  if (name.find("::") == std::string::npos) name = library + "::" + name;
  const auto found = profiles.find(name);
  if (found == profiles.end()) source.fail(element, "no profile '" + name + "' stands above it");
  return found->second;
}

QosProvider::Profile read_profile(const qos_xml::Source& source, const pugi::xml_node& element,
                                  QosProvider::Profile profile) {
  const std::map<std::string_view, Qos*> parts{{"datawriter_qos", &profile.datawriter},
                                               {"datareader_qos", &profile.datareader},
                                               {"topic_qos", &profile.topic},
                                               {"domainparticipant_qos", &profile.participant}};
  std::set<std::string_view> seen;
  for (const pugi::xml_node child : element.children()) {
    if (child.type() != pugi::node_element) source.fail(element, "unexpected text");
    const auto part = parts.find(child.name());
    if (part == parts.end()) source.fail(child, "unknown element in <qos_profile>");
    if (!seen.insert(child.name()).second) source.fail(child, "stands twice");
    qos_xml::read_policies(source, child, *part->second);
  }
  return profile;
}

Profiles read_file(const qos_xml::Source& source) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed =
      document.load_buffer(source.text().data(), source.text().size(), pugi::parse_default);
  if (!parsed) source.fail_at(parsed.offset, std::string("not well-formed XML: ") + parsed.description());

  Profiles profiles;
  std::set<std::string> libraries;
  for (const pugi::xml_node root : children_of(source, document, "dds")) {
    source.check_attributes(root, {"xmlns", "xmlns:xsi", "xsi:schemaLocation"});
    if (root != document.first_child()) source.fail(root, "stands twice");
    for (const pugi::xml_node library : children_of(source, root, "qos_library")) {
      source.check_attributes(library, {"name"});
      const std::string library_name = name_of(source, library);
      if (!libraries.insert(library_name).second) {
        source.fail(library, "'" + library_name + "' stands twice");
      }
      for (const pugi::xml_node element : children_of(source, library, "qos_profile")) {
        source.check_attributes(element, {"name", "base_name"});
        const std::string name = library_name + "::" + name_of(source, element);
        if (profiles.contains(name)) source.fail(element, "'" + name + "' stands twice");
        profiles.emplace(name,
                         read_profile(source, element, inherited(source, element, library_name, profiles)));
      }
    }
  }
  if (profiles.empty()) throw QosFileError(source.name() + ": holds no <qos_profile>");
  return profiles;
}

}  // namespace

std::filesystem::path find_qos_file(const std::optional<std::filesystem::path>& explicit_path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto asked_for = [&](const fs::path& path, const std::string& by) {
    if (!fs::is_regular_file(path, error)) {
      throw QosFileError(path.string() + ": no such QoS file (asked for by " + by + ")");
    }
    return path;
  };
  if (explicit_path) return asked_for(*explicit_path, "the option");
  if (const char* path = std::getenv("SONOPOSE_QOS"); path != nullptr && *path != '\0') {
    return asked_for(path, "SONOPOSE_QOS");
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::vector<fs::path> places{
      program.parent_path().parent_path() / "share/sonopose/qos/sonopose.xml",
      SONOPOSE_SOURCE_QOS_FILE,
      SONOPOSE_INSTALLED_QOS_FILE,
  };
  std::string looked_at;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place, error)) return place;
    looked_at += "\n  " + place.string();
  }
  throw QosFileError("no QoS file; set SONOPOSE_QOS. Looked for:" + looked_at);
}

QosProvider::QosProvider(const std::filesystem::path& file) : file_(file.string()) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw QosFileError(file_ + ": cannot be read");
  profiles_ = read_file(qos_xml::Source(file_, text.str()));
}

QosProvider QosProvider::from_string(const std::string& xml, const std::string& name) {
  QosProvider provider;
  provider.file_ = name;
  provider.profiles_ = read_file(qos_xml::Source(name, xml));
  return provider;
}

const QosProvider::Profile& QosProvider::find(const std::string& profile) const {
  const auto found = profiles_.find(profile);
  if (found == profiles_.end()) throw QosFileError(file_ + ": has no <qos_profile> '" + profile + "'");
  return found->second;
}

const Qos& QosProvider::datawriter_qos(const std::string& profile) const {
  return find(profile).datawriter;
}
const Qos& QosProvider::datareader_qos(const std::string& profile) const {
  return find(profile).datareader;
}
const Qos& QosProvider::topic_qos(const std::string& profile) const {
  return find(profile).topic;
}
const Qos& QosProvider::participant_qos(const std::string& profile) const {
  return find(profile).participant;
}

}  // namespace sonopose::dds
