#include "security/store_revocations.hpp"

#include "files/replacement.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"
#include "security/revocation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::exists(fs::symlink_status(file, error));
}

/// True if a store has, or had, a list of revoked certificates. One of SROS2 need not have.
bool must_have_list(const fs::path& store, const std::string& issuer_pem) {
  if (has_own_list(facts_of(issuer_pem, "authority"))) return true;
  if (is_there(store / "public" / revocation_file) || is_there(store / "private" / revocation_file))
    return true;
  return std::ranges::any_of(files_below(store / "enclaves"),
                             [](const fs::path& file) { return file.filename() == revocation_file; });
}

struct RevocationList {
  std::string text;
  std::set<std::string> serials;
};

/// Reads a list of revoked certificates. Empty, with the reason in `problem`, if it cannot be used.
std::optional<RevocationList> read_list(const fs::path& file, const std::string& issuer_pem,
                                        std::string& problem) {
  try {
    std::string text = read_file(file, "");
    const auto serials = revoked_serials(text, issuer_pem, file.string());
    return RevocationList{std::move(text), {serials.begin(), serials.end()}};
  } catch (const SecurityError& error) {
    if (problem.empty()) problem = error.what();
    return std::nullopt;
  }
}

}  // namespace

std::string revocations(const fs::path& store, const std::string& issuer_pem) {
  if (!must_have_list(store, issuer_pem)) return {};
  const fs::path public_file = store / "public" / revocation_file;
  const fs::path private_file = store / "private" / revocation_file;
  std::string problem;
  const auto list = read_list(public_file, issuer_pem, problem);
  const auto copy = read_list(private_file, issuer_pem, problem);
  if (!list && !copy) throw SecurityError(problem + "; restore it from an enclave of another machine");
  if (!copy || (list && std::ranges::includes(list->serials, copy->serials))) return list->text;
  if (!list || std::ranges::includes(copy->serials, list->serials)) return copy->text;
  throw SecurityError(
      fmt::format("{} and {}: each lacks a certificate that the other revokes; restore one of "
                  "them from an enclave of another machine",
                  public_file.string(), private_file.string()));
}

void write_revocations(const fs::path& store, const std::string& list) {
  files::write_private(store / "private" / revocation_file, list);
  files::write_whole(store / "public" / revocation_file, list);
}

}  // namespace sonopose::security
