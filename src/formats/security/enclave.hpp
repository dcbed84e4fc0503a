#pragma once
/// \file
/// The files of one process, in a folder as SROS2 lays it out.

#include "security/permissions.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace sonopose::security {

inline constexpr const char* certificate_file = "cert.pem";
inline constexpr const char* key_file = "key.pem";
inline constexpr const char* identity_ca_file = "identity_ca.cert.pem";
inline constexpr const char* permissions_ca_file = "permissions_ca.cert.pem";
inline constexpr const char* governance_file = "governance.p7s";
inline constexpr const char* permissions_file = "permissions.p7s";
inline constexpr const char* governance_source = "governance.xml";    ///< of all, in enclaves/
inline constexpr const char* permissions_source = "permissions.xml";  ///< edited, then signed
inline constexpr const char* revocation_file = "crl.pem";             ///< may be absent in stores of SROS2

/// Subject of the authority that KeyStore::create makes.
inline constexpr const char* identity_authority_name = "sonopose identity CA";

/// Returns true for an authority of our own key stores, where each enclave has a list of revoked
/// certificates: one without it may have lost it.
bool has_own_list(const CertificateFacts& identity_authority);

/// State of an enclave that can be used.
struct Enclave {
  std::string subject;       ///< "CN=/bridge"
  std::string serial;        ///< serial number of the certificate
  std::int64_t expires_s{};  ///< first date after which one of its files is invalid
  Grant grant;
  std::string protection;  ///< "sign" or "encrypt"
  /// True if the authority of the identities also signs permissions: any enclave can then sign its own
  /// (CVE-2023-24011). SROS2 makes such stores.
  bool has_common_authority = false;
};

/// Days before the expiry from which on programs warn.
inline constexpr std::int64_t warning_days = 30;

/// Reads and checks the files of an enclave. Throws SecurityError with the file and the verb that repairs it:
/// a file is missing or unreadable, the key is readable by others, a certificate or the permissions are not
/// valid now, or files do not belong together. Only a store of SROS2 may lack crl.pem.
Enclave read_enclave(const std::filesystem::path& folder, std::int64_t now_s);

/// Returns the content of a file. Throws SecurityError with the file and `remedy`.
std::string read_file(const std::filesystem::path& file, const std::string& remedy);

/// Returns "sonopose-security VERB STORE NAME" for an enclave's folder.
std::string command_for(const std::filesystem::path& folder, const std::string& verb);

/// Returns the first dates after which a file of an enclave, and of the others of its store, is invalid, in
/// seconds since 1970, by the name of the enclave; those that cannot be read are missing. Nothing for an
/// empty folder.
std::map<std::string, std::int64_t> expiries_beside(const std::filesystem::path& folder);

/// Returns "expires in 12 days, at 2026-12-11" if that is within the days of a warning, otherwise nothing.
std::string expiry_warning(std::int64_t expires_s, std::int64_t now_s);

}  // namespace sonopose::security
