#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

/// Returns the certificates below a folder that the permissions authority issued, itself excluded.
std::vector<fs::path> leaves_of(const std::string& authority, const fs::path& folder) {
  std::vector<fs::path> leaves;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::error_code unreadable;
    if (entry.is_symlink() || !entry.is_regular_file(unreadable)) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    if (text.find("BEGIN CERTIFICATE") == text.npos || text == authority) continue;
    try {
      if (is_issued_by(text, authority)) leaves.push_back(entry.path());
    } catch (const SecurityError&) {  // NOLINT(bugprone-empty-catch): a broken one authorises nobody
    }
  }
  std::ranges::sort(leaves);
  return leaves;
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
