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

namespace sonopose::dds {

/// A QoS file that cannot be used. `what()` is `file:line: <element>: reason`.
class QosFileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The project's own QoS file: the one installed next to the running program (../share/sonopose/qos), else
/// that of the source tree, else that of the installation prefix. Throws `QosFileError` where there is none.
std::filesystem::path project_qos_file();

/// The file of a user's own that is laid over the project's: `asked_for` if given, else the environment's
/// SONOPOSE_QOS, else none. Throws `QosFileError` where the one that was asked for is not there.
std::optional<std::filesystem::path> qos_overrides(
    const std::optional<std::filesystem::path>& asked_for = std::nullopt);

/// Reads files strictly: an unknown element or attribute, a value out of range, an element given twice, a
/// profile given twice are `QosFileError`s. `base_name` inherits from a profile further up in the file.
class QosProvider {
public:
  /// The project's profiles, with those of `qos_overrides(overrides)` laid over them.
  explicit QosProvider(const std::optional<std::filesystem::path>& overrides = std::nullopt);

  /// One whole file alone, from text; `name` stands for the file in errors.
  static QosProvider from_string(const std::string& xml, const std::string& name);

  /// Lays a user's file over what is here. A profile of one of the libraries here need hold only the policies
  /// that it changes; they are changed for this profile alone, not for those that inherit from it here. What
  /// `base_name` brings in (from a profile further up in the file, else from one here) is laid over as well.
  /// Other libraries may hold profiles to inherit from. Throws `QosFileError` and changes nothing, besides as
  /// above: for a profile that its library here does not have or whose reader would no longer match its
  /// writer, and for a file that changes no profile.
  void lay_over(const std::string& xml, const std::string& name);

  /// The full names of all profiles: "Library::Profile".
  std::vector<std::string> profiles() const;

  /// The QoS of a profile named `Library::Profile`. Policies that it does not set are left to the DDS
  /// default. Throws `QosFileError` for a profile that the file does not have.
  const Qos& datawriter_qos(const std::string& profile) const;
  const Qos& datareader_qos(const std::string& profile) const;
  const Qos& topic_qos(const std::string& profile) const;
  const Qos& participant_qos(const std::string& profile) const;

  /// The four sets that a profile holds.
  struct Profile {
    Qos datawriter;
    Qos datareader;
    Qos topic;
    Qos participant;
  };

private:
  struct Empty {};
  explicit QosProvider(Empty) {}
  const Profile& find(const std::string& profile) const;

  std::string file_;
  std::map<std::string, Profile> profiles_;
};

}  // namespace sonopose::dds
