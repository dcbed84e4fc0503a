#pragma once
/// \file
/// QoS from an OMG DDS-XML file: the only source of QoS in this system.

#include <sonopose/dds/psm/qos.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::dds::qos {

/// An invalid QoS file. `what()` is `file:line: <element>: reason`. It begins with SONOPOSE_QOS if that names
/// the file.
class FileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The project's QoS file: the one installed next to the running program (../share/sonopose/qos), otherwise
/// that of the source tree, otherwise that of the installation prefix. Throws `FileError` if there is none.
std::filesystem::path project_file();

/// The user's file to merge over the project's: `requested` if given, otherwise the environment variable
/// SONOPOSE_QOS, otherwise none. Throws `FileError` if the file does not exist.
std::optional<std::filesystem::path> overrides_file(
    const std::optional<std::filesystem::path>& requested = std::nullopt);

/// Reads files strictly: an unknown element or attribute, a value out of range, or an element or profile
/// given twice is a `FileError`. `base_name` inherits from an earlier profile of the file.
class Provider {
public:
  /// Loads the project's profiles and merges those of `overrides_file(overrides)` over them. A file of more
  /// than 1 MiB is a `FileError`.
  explicit Provider(const std::optional<std::filesystem::path>& overrides = std::nullopt);

  /// Reads one complete file from text; `name` is the file name in errors.
  static Provider from_string(const std::string& xml, const std::string& name);

  /// Merges a user's file over the current profiles. A profile of a current library contains only the
  /// policies that it changes. They apply to this profile alone, not to those that inherit from it. Policies
  /// inherited by `base_name` (from an earlier profile of the file, otherwise from a current one) are merged
  /// as well. Other libraries may contain profiles to inherit from. Throws `FileError` and changes nothing if
  /// the file is invalid or changes no profile, if a current library lacks one of its profiles, or if a
  /// profile's reader would no longer match its writer.
  void merge(const std::string& xml, const std::string& name);

  /// Full names of all profiles: "Library::Profile".
  std::vector<std::string> profiles() const;

  /// QoS of a profile named `Library::Profile`. Unset policies have the DDS default. Throws `FileError` if
  /// there is no such profile.
  const Qos& datawriter_qos(const std::string& profile) const;
  const Qos& datareader_qos(const std::string& profile) const;
  const Qos& topic_qos(const std::string& profile) const;
  const Qos& participant_qos(const std::string& profile) const;

  /// The four QoS sets of a profile.
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
