#pragma once
/// \file
/// QoS from an OMG DDS-XML file: the only source of QoS in this system.

#include <sonopose/dds/binding/qos.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::dds::qos {

/// An invalid QoS file. `what()` is `file:line: <element>: reason`.
class FileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The project's QoS file: the one installed next to the running program (../share/sonopose/qos), otherwise
/// that of the source tree, otherwise that of the installation prefix. Throws `FileError` if there is none.
std::filesystem::path project_file();

/// The user's file that is merged over the project's: `requested` if given, otherwise the environment
/// variable SONOPOSE_QOS, otherwise none. Throws `FileError` if the file does not exist.
std::optional<std::filesystem::path> overrides_file(
    const std::optional<std::filesystem::path>& requested = std::nullopt);

/// Reads files strictly: an unknown element or attribute, a value out of range, an element given twice, a
/// profile given twice are `FileError`s. `base_name` inherits from an earlier profile of the file.
class Provider {
public:
  /// The project's profiles with those of `overrides_file(overrides)` merged over them.
  explicit Provider(const std::optional<std::filesystem::path>& overrides = std::nullopt);

  /// One complete file, from text; `name` is the file name in errors.
  static Provider from_string(const std::string& xml, const std::string& name);

  /// Merges a user's file over the current profiles. A profile of a current library contains only the
  /// policies that it changes, for this profile alone and not for those that inherit from it. Policies that
  /// it inherits by `base_name` (from an earlier profile of the file, otherwise from a current one) are
  /// merged as well. Other libraries may contain profiles to inherit from. Throws `FileError` and changes
  /// nothing for an invalid file, for a profile that its current library does not have, for one whose reader
  /// would no longer match its writer, and for a file that changes no profile.
  void merge(const std::string& xml, const std::string& name);

  /// The full names of all profiles: "Library::Profile".
  std::vector<std::string> profiles() const;

  /// The QoS of a profile named `Library::Profile`. Policies that it does not set have the DDS default.
  /// Throws `FileError` if there is no such profile.
  const Qos& datawriter_qos(const std::string& profile) const;
  const Qos& datareader_qos(const std::string& profile) const;
  const Qos& topic_qos(const std::string& profile) const;
  const Qos& participant_qos(const std::string& profile) const;

  /// The four sets of a profile.
  struct Profile {
    Qos datawriter;
    Qos datareader;
    Qos topic;
    Qos participant;
  };

private:
  struct Empty {};
  explicit Provider(Empty) {}
  const Profile& find(const std::string& profile) const;

  std::string file_;
  std::map<std::string, Profile> profiles_;
};

}  // namespace sonopose::dds::qos
