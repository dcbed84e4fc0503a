#include "files/input_file.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"

#include <algorithm>
#include <stdexcept>
#include <system_error>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

/// Returns the certificates below a folder that the permissions authority issued, itself excluded.
std::vector<fs::path> leaves_of(const std::string& authority, const fs::path& folder) {
  std::vector<fs::path> leaves;
  for (const fs::path& path : files_below(folder)) {
    std::error_code unreadable;
    if (fs::is_symlink(path, unreadable) || !fs::is_regular_file(path, unreadable)) continue;
    try {
      const std::string text = files::read_text(path);
      if (text.find("BEGIN CERTIFICATE") == text.npos || text == authority) continue;
      if (is_issued_by(text, authority)) leaves.push_back(path);
    } catch (const std::runtime_error&) {  // NOLINT(bugprone-empty-catch): a broken one authorises nobody
    }
  }
  return leaves;
}

/// Adds what is wrong with the authorities, whose private keys are absent where a machine has only enclaves.
void check_authorities(const KeyStore& store, std::int64_t now_s, std::vector<StoreProblem>& problems) {
  const fs::path secret = store.folder() / "private";
  const auto check_mode = [&problems](const fs::path& path, const char* mode) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    constexpr fs::perms others = fs::perms::group_all | fs::perms::others_all;
    if (!fs::exists(status) || (status.permissions() & others) == fs::perms::none) return;
    problems.push_back({path.string(), "open to other users, who could make enclaves; run chmod " +
                                           (mode + (" " + path.string())) +
                                           ", and make a new store if somebody has read it"});
  };
  check_mode(secret, "700");
  for (const std::string name : {"identity_ca", "permissions_ca"}) {
    check_mode(secret / (name + ".key.pem"), "600");
    const fs::path certificate = store.folder() / "public" / (name + ".cert.pem");
    try {
      const Validity validity =
          facts_of(read_file(certificate, "the store lacks an authority"), certificate.string()).validity;
      std::string text = expiry_warning(validity.not_after_s, now_s);
      if (now_s < validity.not_before_s) text = "not valid before " + date_time_text(validity.not_before_s);
      if (!text.empty()) problems.push_back({certificate.string(), text + "; make a new store"});
    } catch (const SecurityError& error) {
      problems.push_back({certificate.string(), error.what()});
    }
  }
}

}  // namespace

std::vector<StoreProblem> check(const KeyStore& store, std::int64_t now_s) {
  std::vector<StoreProblem> problems;
  const fs::path authority = store.folder() / "public" / permissions_ca_file;
  const std::string signer = read_file(authority, "the store has no permissions authority");
  for (const fs::path& leaf : leaves_of(signer, store.folder())) {
    problems.push_back({leaf.string(),
                        "issued by the permissions authority: its owner can sign permissions that Cyclone "
                        "DDS accepts (CVE-2023-24011); make a new store, whose authorities are separate"});
  }
  check_authorities(store, now_s, problems);
  for (const std::string& name : store.enclaves()) {
    try {
      const Enclave enclave = read_enclave(store.enclave_folder(name), now_s);
      const std::string warning = expiry_warning(enclave.expires_s, now_s);
      if (!warning.empty()) {
        problems.push_back({name, warning + "; run " + command_for(store.enclave_folder(name), "renew")});
      }
    } catch (const SecurityError& error) {
      problems.push_back({name, error.what()});
    }
  }
  return problems;
}

}  // namespace sonopose::security
