#include "security/enclave.hpp"

#include "files/error.hpp"
#include "files/input_file.hpp"
#include "security/error.hpp"
#include "security/revocation.hpp"
#include "security/signed_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <system_error>
#include <unistd.h>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

/// Returns the key store of an enclave's folder.
fs::path store_of(const fs::path& folder) {
  fs::path root = folder;
  while (root.has_parent_path() && root != root.parent_path() && root.filename() != "enclaves") {
    root = root.parent_path();
  }
  return root.parent_path();
}

bool is_certificate_of_authority(std::string_view file) {
  return file == identity_ca_file || file == permissions_ca_file;
}

bool is_present(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

/// The files of one enclave, with the errors that name them, and the command that repairs them.
class EnclaveFiles {
public:
  explicit EnclaveFiles(const fs::path& folder) : folder_(folder) {
    std::error_code error;
    if (fs::is_directory(folder, error)) return;
    throw SecurityError(
        fmt::format("{}: no such enclave; run {}", folder.string(), command_for(folder, "enclave")));
  }

  [[nodiscard]] std::string path(const char* file) const { return (folder_ / file).string(); }

  [[nodiscard]] std::string read(const char* file) const { return read_file(folder_ / file, remedy(file)); }

  /// Returns what `reader` makes of a file's text and path. Adds the remedy to its error.
  template <class Reader>
  [[nodiscard]] auto parsed(const char* file, const std::string& text, const Reader& reader) const {
    try {
      return reader(text, path(file));
    } catch (const SecurityError& error) {
      throw SecurityError(fmt::format("{}; {}", error.what(), remedy(file)));
    }
  }

  [[nodiscard]] std::string command(const std::string& verb) const {
    return "run " + command_for(folder_, verb);
  }

  [[noreturn]] void fail(const char* file, const std::string& why) const { fail(file, why, remedy(file)); }
  [[noreturn]] void fail(const char* file, const std::string& why, const std::string& remedy) const {
    throw SecurityError(fmt::format("{}: {}; {}", path(file), why, remedy));
  }

  void check_dates(const char* file, const Validity& validity, std::int64_t now_s) const {
    if (now_s >= validity.not_after_s) {
      const bool is_authority = is_certificate_of_authority(file);
      fail(file, "expired on " + date_text(validity.not_after_s),
           is_authority ? "make a new key store with sonopose-security init" : remedy(file));
    }
    if (now_s < validity.not_before_s) {
      throw NotYetValid(fmt::format("{}: not valid before {}: is the clock of this machine right?",
                                    path(file), date_time_text(validity.not_before_s)));
    }
  }

  /// Others who can read the key can pass for this process.
  void check_key_mode() const {
    std::error_code error;
    const fs::perms mode = fs::status(folder_ / key_file, error).permissions();
    constexpr fs::perms others = fs::perms::group_all | fs::perms::others_all;
    if (error || (mode & others) == fs::perms::none) return;
    throw SecurityError(
        fmt::format("{0}: readable by other users; if nobody has read it, run chmod 600 {0}, "
                    "otherwise {1}",
                    path(key_file), command_for(folder_, "renew")));
  }

private:
  /// Returns the command that repairs a file. Files of the whole store are links, which `renew` restores.
  [[nodiscard]] std::string remedy(const char* file) const {
    const bool is_governance = std::string_view(file) == governance_file;
    const fs::path shared = store_of(folder_) / (is_governance ? "enclaves" : "public") / file;
    std::error_code no_link;
    const fs::path target = fs::read_symlink(folder_ / file, no_link);
    const bool is_link = !no_link && (folder_ / target).lexically_normal() == shared.lexically_normal();
    if (is_link && is_governance) {
      return fmt::format("run sonopose-security governance {}", store_of(folder_).string());
    }
    if (is_link && is_certificate_of_authority(file)) {
      return "restore it from a copy of an enclave, or make a new key store with sonopose-security init";
    }
    return command("renew");
  }

  fs::path folder_;
};

/// Returns the first date after which a file of an enclave is invalid, whether or not that has passed.
std::int64_t expiry_of(const fs::path& folder) {
  const EnclaveFiles files(folder);
  const std::string signer = files.read(permissions_ca_file);
  const std::string permissions = files.path(permissions_file);
  std::int64_t first_s =
      grant_of(verified_document(files.read(permissions_file), signer, permissions), permissions)
          .validity.not_after_s;
  for (const char* const file : {certificate_file, identity_ca_file, permissions_ca_file}) {
    first_s = std::min(first_s, facts_of(files.read(file), files.path(file)).validity.not_after_s);
  }
  return first_s;
}

}  // namespace

std::string read_file(const fs::path& file, const std::string& remedy) {
  try {
    return files::read_text(file);
  } catch (const files::IoError& error) {
    const bool is_denied = ::access(file.c_str(), R_OK) != 0 && errno == EACCES;
    const std::string advice = is_denied ? "run this as the owner of the file" : remedy;
    throw SecurityError(error.what() + (advice.empty() ? "" : "; " + advice));
  }
}

bool has_own_list(const CertificateFacts& identity_authority) {
  return identity_authority.subject == std::string("CN=") + identity_authority_name;
}

std::string command_for(const fs::path& folder, const std::string& verb) {
  const fs::path store = store_of(folder);
  return fmt::format("sonopose-security {} {} {}", verb, store.string(),
                     folder.lexically_relative(store / "enclaves").string());
}

namespace {

/// Throws SecurityError if the certificate is on the list of the store, or the list is missing.
void check_revocation(const EnclaveFiles& files, const std::string& identity_ca,
                      const CertificateFacts& authority, const CertificateFacts& own) {
  const bool needs_list = has_own_list(authority);
  if (!needs_list && !is_present(files.path(revocation_file))) return;
  const auto revoked = files.parsed(revocation_file, files.read(revocation_file),
                                    [&](const std::string& text, const std::string& path) {
                                      return revoked_serials(text, identity_ca, path);
                                    });
  if (std::ranges::find(revoked, own.serial) == revoked.end()) return;
  files.fail(certificate_file, "revoked", files.command("enclave"));
}

/// Returns the rights in a signed document.
Grant signed_grant(const EnclaveFiles& files, const std::string& permissions_ca) {
  const std::string text = files.parsed(permissions_file, files.read(permissions_file),
                                        [&](const std::string& document, const std::string& path) {
                                          return verified_document(document, permissions_ca, path);
                                        });
  try {
    return grant_of(text, files.path(permissions_file));
  } catch (const SecurityError& error) {
    throw SecurityError(
        fmt::format("{}; edit permissions.xml, then {}", error.what(), files.command("renew")));
  }
}

}  // namespace

Enclave read_enclave(const fs::path& folder, std::int64_t now_s) {
  const EnclaveFiles files(folder);
  const std::string identity_ca = files.read(identity_ca_file);
  const std::string permissions_ca = files.read(permissions_ca_file);
  const std::string certificate = files.read(certificate_file);
  const auto authority = files.parsed(identity_ca_file, identity_ca, facts_of);
  const auto signer = files.parsed(permissions_ca_file, permissions_ca, facts_of);
  const auto facts = files.parsed(certificate_file, certificate, facts_of);
  files.check_key_mode();
  const bool is_own_key = files.parsed(
      key_file, files.read(key_file),
      [&](const std::string& key, const std::string& path) { return is_key_of(key, certificate, path); });
  if (!is_own_key) files.fail(key_file, "not the key of cert.pem");
  if (!is_issued_by(certificate, identity_ca)) {
    files.fail(certificate_file, "not issued by identity_ca.cert.pem");
  }
  files.check_dates(certificate_file, facts.validity, now_s);
  files.check_dates(identity_ca_file, authority.validity, now_s);
  files.check_dates(permissions_ca_file, signer.validity, now_s);

  const Grant grant = signed_grant(files, permissions_ca);
  if (grant.subject != facts.subject) {
    files.fail(permissions_file,
               fmt::format("of {}, but the certificate of {}", grant.subject, facts.subject));
  }
  files.check_dates(permissions_file, grant.validity, now_s);
  const std::string protection =
      files.parsed(governance_file, files.read(governance_file),
                   [&](const std::string& document, const std::string& path) {
                     return protection_in(verified_document(document, permissions_ca, path), path);
                   });
  check_revocation(files, identity_ca, authority, facts);
  return {.subject = facts.subject,
          .serial = facts.serial,
          .expires_s = std::min({facts.validity.not_after_s, authority.validity.not_after_s,
                                 signer.validity.not_after_s, grant.validity.not_after_s}),
          .grant = grant,
          .protection = protection,
          .has_common_authority = identity_ca == permissions_ca};
}

std::map<std::string, std::int64_t> expiries_beside(const fs::path& folder) {
  std::map<std::string, std::int64_t> expiries;
  if (folder.empty()) return expiries;
  fs::path root = folder.parent_path();
  while (root.filename() != "enclaves" && root.has_relative_path()) root = root.parent_path();
  if (!root.has_relative_path()) root = folder.parent_path();
  std::error_code error;
  constexpr auto options = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator each(root, options, error), end; !error && each != end;
       each.increment(error)) {
    if (each->path().filename() != certificate_file) continue;
    const fs::path enclave = each->path().parent_path();
    try {
      expiries[enclave.lexically_relative(root).string()] = expiry_of(enclave);
    } catch (const SecurityError&) {  // NOLINT(bugprone-empty-catch): of another process, which reports it
    }
  }
  return expiries;
}

std::string expiry_warning(std::int64_t expires_s, std::int64_t now_s) {
  const std::int64_t days = (expires_s - now_s) / day_s;
  if (days > warning_days) return {};
  if (now_s >= expires_s) return "expired on " + date_text(expires_s);
  const std::string time = date_time_text(expires_s);
  return days < 1 ? "expires within a day, at " + time : fmt::format("expires in {} days, at {}", days, time);
}

}  // namespace sonopose::security
