#pragma once
/// \file
/// A key store in the layout of SROS2: `public/`, `private/` and `enclaves/NAME/`.

#include "security/authority.hpp"
#include "security/certificate.hpp"
#include "security/permissions.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::security {

/// A key store with its authorities. Every member throws SecurityError or files::IoError with the file. Files
/// are replaced one by one, each atomically; private keys are readable by their owner only.
class KeyStore {
public:
  /// Makes a key store in a folder that is absent or empty.
  static KeyStore create(const std::filesystem::path& folder, Protection protection, std::int64_t now_s);

  /// Opens a key store. Throws SecurityError if the folder is none.
  explicit KeyStore(const std::filesystem::path& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Folder of an enclave, which need not exist. Throws SecurityError for an unusable name, such as "../x".
  [[nodiscard]] std::filesystem::path enclave_folder(const std::string& name) const;

  /// Names of all enclaves, sorted: "bridge", "hall/robot". One file makes a folder an enclave.
  [[nodiscard]] std::vector<std::string> enclaves() const;

  /// Rights of a new enclave, and their dates.
  struct EnclaveOptions {
    std::vector<std::string> roles;
    std::vector<std::string> partitions = {};
    Validity validity = {};
    Handshake handshake = Handshake::either;
  };

  /// Makes an enclave. Throws SecurityError if it exists, unless its certificate is revoked.
  void add(const std::string& name, const EnclaveOptions& options) const;

  /// Makes a new key and certificate with the same subject, signs its permissions.xml again, and links it to
  /// the files of the whole store, where the list of revoked certificates is restored too.
  void renew(const std::string& name, const Validity& validity) const;

  /// Puts every certificate that the enclave had on the list of revoked ones, and deletes its files,
  /// but not those of enclaves below it. Returns the number of certificates.
  std::size_t revoke(const std::string& name, std::int64_t now_s) const;

  /// Signs the governance of all enclaves again: with this protection, or as governance.xml says. Returns
  /// what it changes: "sign → encrypt".
  std::string set_protection(std::optional<Protection> protection) const;

private:
  [[nodiscard]] KeyPair authority(const char* name) const;
  void write_identity(const std::string& name, const KeyPair& identity) const;
  void sign(const std::filesystem::path& document, const std::filesystem::path& file) const;

  std::filesystem::path folder_;
};

/// Throws SecurityError for what cannot be the name of an enclave, such as "../x".
void check_enclave_name(const std::string& name);

/// Returns true if the subject of a certificate or of permissions is the enclave of this name.
bool is_subject_of(const std::string& name, const std::string& subject);

/// Returns all files and links below a folder, sorted. Throws SecurityError with a folder that cannot be
/// read.
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder);

/// One line of check(): an enclave or a file, and what is wrong with it.
struct StoreProblem {
  std::string subject;
  std::string text;
};

/// Checks every enclave, the dates of the authorities and the modes of their keys, that what can be edited is
/// what was signed, and that the permissions authority issued no certificate (CVE-2023-24011).
std::vector<StoreProblem> check(const KeyStore& store, std::int64_t now_s);

}  // namespace sonopose::security
