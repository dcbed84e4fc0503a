#pragma once
/// \file
/// QoS from an OMG DDS-XML file: the only source of QoS in this system.

#include <sonopose/dds/qos.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

namespace sonopose::dds {

/// A QoS file that cannot be used. `what()` is `file:line: <element>: reason`.
class QosFileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Which QoS file applies: `explicit_path` if given, else the environment's SONOPOSE_QOS, else the one
/// installed next to the running program (../share/sonopose/qos), else that of the source tree, else that of
/// the installation prefix. Throws `QosFileError` where there is none; a path that was asked for is not
/// replaced by another.
std::filesystem::path find_qos_file(const std::optional<std::filesystem::path>& explicit_path = std::nullopt);

/// Reads a file strictly: an unknown element or attribute, a value out of range, an element given twice, a
/// profile given twice are `QosFileError`s. `base_name` inherits from a profile further up in the file.
class QosProvider {
public:
  explicit QosProvider(const std::filesystem::path& file);

  /// From text, `name` stands for the file in errors.
  static QosProvider from_string(const std::string& xml, const std::string& name);

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
  QosProvider() = default;
  const Profile& find(const std::string& profile) const;

  std::string file_;
  std::map<std::string, Profile> profiles_;
};

}  // namespace sonopose::dds
