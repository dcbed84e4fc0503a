#include "files/error.hpp"
#include "files/input_file.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"
#include "security/signed_document.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

/// The problem of a file; the message of an error begins with its path.
StoreProblem problem_of(const fs::path& file, std::string_view message) {
  const std::string path = file.string() + ": ";
  if (message.starts_with(path)) message.remove_prefix(path.size());
  return {file.string(), std::string(message)};
}

/// Adds the certificates of the store that the permissions authority issued, itself excluded.
void check_leaves(const KeyStore& store, std::vector<StoreProblem>& problems) {
  std::string authority;
  try {
    authority = read_file(store.folder() / "public" / permissions_ca_file, "");
    facts_of(authority, permissions_ca_file);
  } catch (const SecurityError&) {
    return;  // check_authorities() reports it
  }
  for (const fs::path& path : files_below(store.folder())) {
    std::error_code unreadable;
    if (!fs::is_regular_file(path, unreadable)) continue;  // or what a link leads to
    try {
      if (!holds_leaf_of(files::read_text(path), authority)) continue;
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

/// Returns a text as S/MIME carries it, whose lines end otherwise.
std::string without_returns(std::string text) {
  std::erase(text, '\r');
  return text;
}

/// Adds a document that differs from what was signed, and so is not in force.
void check_edits(const KeyStore& store, const fs::path& folder, const char* source, const char* document,
                 const std::string& command, std::vector<StoreProblem>& problems) {
  const fs::path edited = folder / source;
  std::error_code absent;
  if (!fs::exists(edited, absent)) return;  // a machine may have what was signed only
  try {
    const std::string text = without_returns(read_file(edited, "run " + command));
    const std::string authority = read_file(store.folder() / "public" / permissions_ca_file, "");
    const fs::path file = folder / document;
    const std::string in_force =
        without_returns(verified_document(read_file(file, "run " + command), authority, file.string()));
    if (text == in_force) return;
    problems.push_back({edited.string(),
                        "differs from " + std::string(document) + ", so it is not in force; run " + command});
  } catch (const SecurityError& error) {
    problems.push_back(problem_of(edited, error.what()));
  }
}

void check_enclave(const KeyStore& store, const std::string& name, std::int64_t now_s,
                   std::vector<StoreProblem>& problems) {
  const fs::path folder = store.enclave_folder(name);
  const std::string renewal = command_for(folder, "renew");
  try {
    const Enclave enclave = read_enclave(folder, now_s);
    if (!is_subject_of(name, enclave.subject)) {
      problems.push_back({name, "has the files of " + enclave.subject + "; run " + renewal});
      return;
    }
    const std::string warning = expiry_warning(enclave.expires_s, now_s);
    if (!warning.empty()) problems.push_back({name, warning + "; run " + renewal});
    check_edits(store, folder, permissions_source, permissions_file, renewal, problems);
  } catch (const SecurityError& error) {
    problems.push_back({name, error.what()});
  }
}

}  // namespace

std::vector<StoreProblem> check(const KeyStore& store, std::int64_t now_s) {
  std::vector<StoreProblem> problems;
  check_leaves(store, problems);
  check_authorities(store, now_s, problems);
  check_edits(store, store.folder() / "enclaves", governance_source, governance_file,
              "sonopose-security governance " + store.folder().string(), problems);
  for (const std::string& name : store.enclaves()) check_enclave(store, name, now_s, problems);
  return problems;
}

}  // namespace sonopose::security
