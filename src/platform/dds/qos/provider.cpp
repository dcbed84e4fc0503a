#include "dds/qos/xml_policies.hpp"
#include <sonopose/dds/qos/match.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <pugixml.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace sonopose::dds::qos {
namespace {

using Profiles = std::map<std::string, Provider::Profile>;

/// Returns the `name` attribute, which is required and must not contain the separator.
std::string name_of(const xml::Source& source, const pugi::xml_node& element) {
  std::string name = element.attribute("name").value();
  if (name.empty()) source.fail(element, "attribute 'name' is missing");
  if (name.find("::") != std::string::npos) source.fail(element, "'" + name + "' contains '::'");
  return name;
}

/// Returns the children of `element`, which must all be called `name`.
std::vector<pugi::xml_node> children_of(const xml::Source& source, const pugi::xml_node& element,
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

/// Resolves `base_name`, first earlier in the file, then in the profiles that the file is merged over.
struct Bases {
  const Profiles& same_file;
  const Profiles& base_file;
};

Provider::Profile inherited(const xml::Source& source, const pugi::xml_node& element,
                            const std::string& library, const Bases& bases) {
  const pugi::xml_attribute base = element.attribute("base_name");
  if (base.empty()) return {};
  std::string name = base.value();
  if (name.find("::") == std::string::npos) name = library + "::" + name;
  for (const Profiles* const profiles : {&bases.same_file, &bases.base_file}) {
    const auto found = profiles->find(name);
    if (found != profiles->end()) return found->second;
  }
  source.fail(element, "no profile '" + name + "' precedes it");
}

Provider::Profile read_profile(const xml::Source& source, const pugi::xml_node& element,
                               Provider::Profile profile) {
  const std::map<std::string_view, Qos*> parts{{"datawriter_qos", &profile.datawriter},
                                               {"datareader_qos", &profile.datareader},
                                               {"topic_qos", &profile.topic},
                                               {"domainparticipant_qos", &profile.participant}};
  std::set<std::string_view> seen;
  for (const pugi::xml_node child : element.children()) {
    if (child.type() != pugi::node_element) source.fail(element, "unexpected text");
    const auto part = parts.find(child.name());
    if (part == parts.end()) source.fail(child, "unknown element in <qos_profile>");
    if (!seen.insert(child.name()).second) source.fail(child, "occurs twice");
    xml::read_policies(source, child, *part->second);
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

/// Merges `over` over the profile of this name in `base_file`, if its library is there.
Provider::Profile merged_over(const xml::Source& source, const pugi::xml_node& element,
                              const std::string& name, const Provider::Profile& over,
                              const Profiles& base_file) {
  if (!has_library(base_file, library_of(name))) return over;
  const auto found = base_file.find(name);
  if (found == base_file.end()) {
    std::string known;
    for (const auto& [other, profile] : base_file) {
      if (library_of(other) == library_of(name)) known += (known.empty() ? "" : ", ") + other;
    }
    source.fail(element, "there is no profile '" + name + "' to change; there are " + known);
  }
  Provider::Profile whole = found->second;
  whole.datawriter.merge(over.datawriter);
  whole.datareader.merge(over.datareader);
  whole.topic.merge(over.topic);
  whole.participant.merge(over.participant);
  for (const Qos* const qos : {&whole.datawriter, &whole.datareader, &whole.topic}) {
    xml::check_depth(source, element, *qos);
  }
  const auto reasons = mismatches(whole.datawriter, whole.datareader);
  if (!reasons.empty()) {
    source.fail(element, "writer and reader of '" + name + "' would not match: " + text_of(reasons.front()));
  }
  return whole;
}

/// Returns the profiles of the file, each merged over the one of the same name in `base_file`.
Profiles read_file(const xml::Source& source, const Profiles& base_file = {}) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed =
      document.load_buffer(source.text().data(), source.text().size(), pugi::parse_default);
  if (!parsed) source.fail_at(parsed.offset, std::string("not well-formed XML: ") + parsed.description());

  Profiles profiles;
  std::set<std::string> libraries;
  for (const pugi::xml_node root : children_of(source, document, "dds")) {
    source.check_attributes(root, {"xmlns", "xmlns:xsi", "xsi:schemaLocation"});
    if (root != document.first_child()) source.fail(root, "occurs twice");
    for (const pugi::xml_node library : children_of(source, root, "qos_library")) {
      source.check_attributes(library, {"name"});
      const std::string library_name = name_of(source, library);
      if (!libraries.insert(library_name).second) {
        source.fail(library, "'" + library_name + "' occurs twice");
      }
      for (const pugi::xml_node element : children_of(source, library, "qos_profile")) {
        source.check_attributes(element, {"name", "base_name"});
        const std::string name = library_name + "::" + name_of(source, element);
        if (profiles.contains(name)) source.fail(element, "'" + name + "' occurs twice");
        const auto own =
            read_profile(source, element, inherited(source, element, library_name, {profiles, base_file}));
        profiles.emplace(name, merged_over(source, element, name, own, base_file));
      }
    }
  }
  if (profiles.empty()) throw FileError(source.name() + ": contains no <qos_profile>");
  return profiles;
}

/// Begins the text of an error in the file that the environment names.
constexpr const char* of_variable = "SONOPOSE_QOS: ";

/// Limit of a file's size. The project's own has some kilobytes.
constexpr std::uintmax_t max_file_bytes = 1U << 20U;

/// Reads a file, whose size is checked first.
std::string text_in(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error && size > max_file_bytes) {
    throw FileError(file.string() + ": has " + std::to_string(size) + " bytes, the limit of a QoS file is " +
                    std::to_string(max_file_bytes));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text(max_file_bytes + 1, '\0');  // a pipe has no size
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || !stream.is_open()) throw FileError(file.string() + ": cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > max_file_bytes) {
    throw FileError(file.string() + ": has more than " + std::to_string(max_file_bytes) +
                    " bytes, the limit of a QoS file");
  }
  return text;
}

}  // namespace

std::filesystem::path project_file() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::vector<fs::path> places{
      program.parent_path().parent_path() / "share/sonopose/qos/sonopose.xml",
      SONOPOSE_SOURCE_QOS_FILE,
      SONOPOSE_INSTALLED_QOS_FILE,
  };
  std::string searched;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place, error)) return place;
    searched += "\n  " + place.string();
  }
  throw FileError("the project's QoS file sonopose.xml does not exist. Searched:" + searched);
}

std::optional<std::filesystem::path> overrides_file(const std::optional<std::filesystem::path>& requested) {
  const char* const variable = std::getenv("SONOPOSE_QOS");
  const bool by_variable = !requested && variable != nullptr && *variable != '\0';
  if (!requested && !by_variable) return std::nullopt;
  const std::filesystem::path path = by_variable ? std::filesystem::path(variable) : *requested;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    const bool exists = std::filesystem::exists(path, error);
    throw FileError((by_variable ? of_variable : "") + path.string() +
                    (exists ? ": is not a file" : ": does not exist"));
  }
  return path;
}

Provider::Provider(const std::optional<std::filesystem::path>& overrides) : file_(project_file().string()) {
  profiles_ = read_file(xml::Source(file_, text_in(file_)));
  const auto path = overrides_file(overrides);
  if (!path) return;
  try {
    merge(text_in(*path), path->string());
  } catch (const FileError& error) {
    if (overrides) throw;
    throw FileError(of_variable + std::string(error.what()));
  }
}

Provider Provider::from_string(const std::string& xml, const std::string& name) {
  Provider provider{Empty{}};
  provider.file_ = name;
  provider.profiles_ = read_file(xml::Source(name, xml));
  return provider;
}

void Provider::merge(const std::string& xml, const std::string& name) {
  Profiles changed = read_file(xml::Source(name, xml), profiles_);
  std::erase_if(changed, [this](const auto& entry) { return !profiles_.contains(entry.first); });
  if (changed.empty()) {
    std::string libraries;
    for (const auto& entry : profiles_) {
      const std::string library = "'" + library_of(entry.first) + "'";
      if (libraries.find(library) == std::string::npos)
        libraries += (libraries.empty() ? "" : " or ") + library;
    }
    throw FileError(name + ": changes no profile: no <qos_library> is called " + libraries);
  }
  for (auto& [profile, qos] : changed) profiles_.insert_or_assign(profile, std::move(qos));
}

std::vector<std::string> Provider::profiles() const {
  std::vector<std::string> names;
  for (const auto& entry : profiles_) names.push_back(entry.first);
  return names;
}

const Provider::Profile& Provider::find(const std::string& profile) const {
  const auto found = profiles_.find(profile);
  if (found == profiles_.end()) throw FileError(file_ + ": has no <qos_profile> '" + profile + "'");
  return found->second;
}

const Qos& Provider::datawriter_qos(const std::string& profile) const {
  return find(profile).datawriter;
}
const Qos& Provider::datareader_qos(const std::string& profile) const {
  return find(profile).datareader;
}
const Qos& Provider::topic_qos(const std::string& profile) const {
  return find(profile).topic;
}
const Qos& Provider::participant_qos(const std::string& profile) const {
  return find(profile).participant;
}

}  // namespace sonopose::dds::qos
