#include "security/enclave.hpp"

#include "files/error.hpp"
#include "files/input_file.hpp"
#include "security/error.hpp"
#include "security/revocation.hpp"
#include "security/signed_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <unistd.h>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

/// The files of one enclave, with the errors that name them.
class Files {
public:
  explicit Files(const fs::path& folder) : folder_(folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) fail(folder.string(), "no such enclave", "enclave");
  }

  [[nodiscard]] std::string path(const char* file) const { return (folder_ / file).string(); }

  [[nodiscard]] std::string read(const char* file) const {
    return read_file(folder_ / file, "make it with " + command_for(folder_, "enclave"));
  }

  [[noreturn]] void fail(const std::string& what, const std::string& why, const std::string& verb) const {
    throw SecurityError(fmt::format("{}: {}; run {}", what, why, command_for(folder_, verb)));
  }

  void check_dates(const std::string& what, const Validity& validity, std::int64_t now_s,
                   const std::string& verb) const {
    if (now_s >= validity.not_after_s) {
      fail(what, "expired on " + date_text(validity.not_after_s), verb);
    }
    if (now_s < validity.not_before_s) {
      throw SecurityError(fmt::format("{}: not valid before {}: is the clock of this machine right?", what,
                                      date_time_text(validity.not_before_s)));
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
  fs::path folder_;
};

/// Returns the first date after which a file of an enclave is invalid, whether or not that has passed.
std::int64_t expiry_of(const fs::path& folder) {
  const Files files(folder);
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

std::string command_for(const fs::path& folder, const std::string& verb) {
  fs::path store = folder;
  while (store.has_parent_path() && store != store.parent_path() && store.filename() != "enclaves") {
    store = store.parent_path();
  }
  const fs::path name = folder.lexically_relative(store);
  return fmt::format("sonopose-security {} {} {}", verb, store.parent_path().string(), name.string());
}

Enclave read_enclave(const fs::path& folder, std::int64_t now_s) {
  const Files files(folder);
  const std::string identity_ca = files.read(identity_ca_file);
  const std::string permissions_ca = files.read(permissions_ca_file);
  const std::string certificate = files.read(certificate_file);
  const CertificateFacts facts = facts_of(certificate, files.path(certificate_file));
  files.check_key_mode();
  const std::string key = files.read(key_file);
  if (!is_key_of(key, certificate, files.path(key_file))) {
    files.fail(files.path(key_file), "not the key of cert.pem", "renew");
  }
  if (!is_issued_by(certificate, identity_ca)) {
    files.fail(files.path(certificate_file), "not issued by identity_ca.cert.pem", "enclave");
  }
  files.check_dates(files.path(certificate_file), facts.validity, now_s, "renew");
  const auto authority = facts_of(identity_ca, files.path(identity_ca_file));
  files.check_dates(files.path(identity_ca_file), authority.validity, now_s, "init");
  const auto signer = facts_of(permissions_ca, files.path(permissions_ca_file));
  files.check_dates(files.path(permissions_ca_file), signer.validity, now_s, "init");

  const std::string permissions = files.path(permissions_file);
  const Grant grant =
      grant_of(verified_document(files.read(permissions_file), permissions_ca, permissions), permissions);
  if (grant.subject != facts.subject) {
    files.fail(permissions, fmt::format("of {}, but the certificate of {}", grant.subject, facts.subject),
               "renew");
  }
  files.check_dates(permissions, grant.validity, now_s, "renew");
  const std::string governance = files.path(governance_file);
  const std::string protection =
      protection_in(verified_document(files.read(governance_file), permissions_ca, governance), governance);

  std::error_code absent;
  if (fs::exists(folder / revocation_file, absent)) {
    const auto revoked =
        revoked_serials(files.read(revocation_file), identity_ca, files.path(revocation_file));
    if (std::ranges::find(revoked, facts.serial) != revoked.end()) {
      files.fail(files.path(certificate_file), "revoked", "enclave");
    }
  }
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
  return fmt::format("expires in {} days, at {}", days, date_time_text(expires_s));
}

}  // namespace sonopose::security
