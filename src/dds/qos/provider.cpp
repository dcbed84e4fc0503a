#include "dds/qos/xml.hpp"
#include <sonopose/dds/qos/match.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <pugixml.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

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

/// Where `base_name` looks: further up in the file, then among what the file is laid over.
struct Bases {
  const Profiles& above;
  const Profiles& beneath;
};

QosProvider::Profile inherited(const qos_xml::Source& source, const pugi::xml_node& element,
                               const std::string& library, const Bases& bases) {
  const pugi::xml_attribute base = element.attribute("base_name");
  if (base.empty()) return {};
  std::string name = base.value();
  if (name.find("::") == std::string::npos) name = library + "::" + name;
  for (const Profiles* const profiles : {&bases.above, &bases.beneath}) {
    const auto found = profiles->find(name);
    if (found != profiles->end()) return found->second;
  }
  source.fail(element, "no profile '" + name + "' stands above it");
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

std::string library_of(const std::string& profile) {
  return profile.substr(0, profile.find("::"));
}

bool has_library(const Profiles& profiles, const std::string& library) {
  return std::any_of(profiles.begin(), profiles.end(),
                     [&](const auto& entry) { return library_of(entry.first) == library; });
}

/// `over` laid over the profile of this name in `beneath`, where its library is one of them.
QosProvider::Profile laid_over(const qos_xml::Source& source, const pugi::xml_node& element,
                               const std::string& name, const QosProvider::Profile& over,
                               const Profiles& beneath) {
  if (!has_library(beneath, library_of(name))) return over;
  const auto found = beneath.find(name);
  if (found == beneath.end()) {
    std::string known;
    for (const auto& [other, profile] : beneath) {
      if (library_of(other) == library_of(name)) known += (known.empty() ? "" : ", ") + other;
    }
    source.fail(element, "there is no profile '" + name + "' to change; there are " + known);
  }
  QosProvider::Profile whole = found->second;
  whole.datawriter.merge(over.datawriter);
  whole.datareader.merge(over.datareader);
  whole.topic.merge(over.topic);
  whole.participant.merge(over.participant);
  for (const Qos* const qos : {&whole.datawriter, &whole.datareader, &whole.topic}) {
    qos_xml::check_depth(source, element, *qos);
  }
  const auto mismatches = qos_mismatches(whole.datawriter, whole.datareader);
  if (!mismatches.empty()) {
    source.fail(element,
                "writer and reader of '" + name + "' would not match: " + text_of(mismatches.front()));
  }
  return whole;
}

/// The profiles that the file holds, each laid over that of the same name in `beneath`.
Profiles read_file(const qos_xml::Source& source, const Profiles& beneath = {}) {
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
        const auto own =
            read_profile(source, element, inherited(source, element, library_name, {profiles, beneath}));
        profiles.emplace(name, laid_over(source, element, name, own, beneath));
      }
    }
  }
  if (profiles.empty()) throw QosFileError(source.name() + ": holds no <qos_profile>");
  return profiles;
}

std::string text_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw QosFileError(file.string() + ": cannot be read");
  return text.str();
}

}  // namespace

std::filesystem::path project_qos_file() {
  namespace fs = std::filesystem;
  std::error_code error;
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
  throw QosFileError("the project's QoS file sonopose.xml is not there. Looked for:" + looked_at);
}

std::optional<std::filesystem::path> qos_overrides(const std::optional<std::filesystem::path>& asked_for) {
  const char* const variable = std::getenv("SONOPOSE_QOS");
  const bool by_variable = !asked_for && variable != nullptr && *variable != '\0';
  if (!asked_for && !by_variable) return std::nullopt;
  const std::filesystem::path path = by_variable ? std::filesystem::path(variable) : *asked_for;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw QosFileError(path.string() + ": no such QoS file (asked for by " +
                       (by_variable ? "SONOPOSE_QOS" : "the option") + ")");
  }
  return path;
}

QosProvider::QosProvider(const std::optional<std::filesystem::path>& overrides)
    : file_(project_qos_file().string()) {
  profiles_ = read_file(qos_xml::Source(file_, text_in(file_)));
  if (const auto path = qos_overrides(overrides)) lay_over(text_in(*path), path->string());
}

QosProvider QosProvider::from_string(const std::string& xml, const std::string& name) {
  QosProvider provider{Empty{}};
  provider.file_ = name;
  provider.profiles_ = read_file(qos_xml::Source(name, xml));
  return provider;
}

void QosProvider::lay_over(const std::string& xml, const std::string& name) {
  Profiles changed = read_file(qos_xml::Source(name, xml), profiles_);
  std::erase_if(changed, [this](const auto& entry) { return !profiles_.contains(entry.first); });
  if (changed.empty()) {
    std::string libraries;
    for (const auto& entry : profiles_) {
      const std::string library = "'" + library_of(entry.first) + "'";
      if (libraries.find(library) == std::string::npos)
        libraries += (libraries.empty() ? "" : " or ") + library;
    }
    throw QosFileError(name + ": changes no profile: no <qos_library> is called " + libraries);
  }
  for (auto& [profile, qos] : changed) profiles_.insert_or_assign(profile, std::move(qos));
}

std::vector<std::string> QosProvider::profiles() const {
  std::vector<std::string> names;
  for (const auto& entry : profiles_) names.push_back(entry.first);
  return names;
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
