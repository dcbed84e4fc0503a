#include "files/error.hpp"
#include "files/input_file.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

bool is_leaf(const std::string& text, const std::string& authority) {
  if (text.find("BEGIN CERTIFICATE") == text.npos || text == authority) return false;
  try {
    return is_issued_by(text, authority);
  } catch (const SecurityError&) {  // a broken one authorises nobody
    return false;
  }
}

/// The problem of a file; the message of an error begins with its path.
StoreProblem problem_of(const fs::path& file, std::string_view message) {
  const std::string path = file.string() + ": ";
  if (message.starts_with(path)) message.remove_prefix(path.size());
  return {file.string(), std::string(message)};
}

/// Adds the certificates of the store that the permissions authority issued, itself excluded.
void check_leaves(const KeyStore& store, std::vector<StoreProblem>& problems) {
  const std::string authority =
      read_file(store.folder() / "public" / permissions_ca_file, "the store has no permissions authority");
  for (const fs::path& path : files_below(store.folder())) {
    std::error_code unreadable;
    if (fs::is_symlink(path, unreadable) || !fs::is_regular_file(path, unreadable)) continue;
    try {
      if (!is_leaf(files::read_text(path), authority)) continue;
      problems.push_back({path.string(),
                          "issued by the permissions authority: its owner can sign permissions that Cyclone "
                          "DDS accepts (CVE-2023-24011); make a new store, whose authorities are separate"});
    } catch (const files::IoError& error) {
      if (path.filename() == key_file) continue;  // a problem of its enclave
      problems.push_back(problem_of(path, error.what()));
    }
  }
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
      problems.push_back(problem_of(certificate, error.what()));
    }
  }
}

}  // namespace

std::vector<StoreProblem> check(const KeyStore& store, std::int64_t now_s) {
  std::vector<StoreProblem> problems;
  check_leaves(store, problems);
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
